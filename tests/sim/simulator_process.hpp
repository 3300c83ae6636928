// A simulator as a process of its own, for one test: started, steered by lines, ended with it.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace binpick {

class SimulatorProcess {
 public:
  // Waits until the program says that it is ready. Throws std::runtime_error with what it said
  // when it is not within 20 s.
  SimulatorProcess(const std::string& program, const std::vector<std::string>& arguments);
  ~SimulatorProcess();  // kills it, unless it has ended
  SimulatorProcess(const SimulatorProcess&) = delete;
  SimulatorProcess& operator=(const SimulatorProcess&) = delete;

  // Its answer to a line, without the line end; "" when it has ended.
  std::string tell(const std::string& line);
  // The number behind "NAME=" in its status.
  long long counter(const std::string& name);
  pid_t pid() const { return pid_; }
  // Asks it to quit and gives its exit status.
  int quit();

 private:
  std::string read_line(int timeout_ms);

  pid_t pid_ = -1;
  int in_ = -1, out_ = -1;
  std::string text_;
};

// An address of this machine that no other process's test has: 127.a.b.c with a and b from the
// process id and c from a count.
std::string loopback_address();

}  // namespace binpick
