#include "simulator_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

namespace binpick {

SimulatorProcess::SimulatorProcess(const std::string& program,
                                   const std::vector<std::string>& arguments) {
  int in[2], out[2];
  if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0) throw std::runtime_error("no pipes");
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    dup2(in[0], STDIN_FILENO);
    dup2(out[1], STDOUT_FILENO);
    execv(program.c_str(), words.data());
    _exit(127);
  }
  close(in[0]);
  close(out[1]);
  in_ = in[1];
  out_ = out[0];
  const std::string first = read_line(20000);
  if (first.find(": ready") == std::string::npos) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    close(in_);
    close(out_);
    throw std::runtime_error(program + " is not ready: " + first);
  }
}

SimulatorProcess::~SimulatorProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  close(in_);
  close(out_);
}

std::string SimulatorProcess::read_line(int timeout_ms) {
  while (true) {
    const std::size_t end = text_.find('\n');
    if (end != std::string::npos) {
      const std::string line = text_.substr(0, end);
      text_.erase(0, end + 1);
      return line;
    }
    pollfd entry{out_, POLLIN, 0};
    if (poll(&entry, 1, timeout_ms) <= 0) return "";
    char buffer[1024];
    const ssize_t count = read(out_, buffer, sizeof buffer);
    if (count <= 0) return "";
    text_.append(buffer, static_cast<std::size_t>(count));
  }
}

std::string SimulatorProcess::tell(const std::string& line) {
  const std::string text = line + "\n";
  if (write(in_, text.data(), text.size()) < 0) return "";
  return read_line(10000);
}

long long SimulatorProcess::counter(const std::string& name) {
  const std::string status = tell("status");
  const std::size_t at = status.find(" " + name + "=");
  if (at == std::string::npos) throw std::runtime_error("no " + name + " in: " + status);
  return std::atoll(status.c_str() + at + name.size() + 2);
}

int SimulatorProcess::quit() {
  tell("quit");
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string loopback_address() {
  static int count = 0;
  const int pid = getpid();
  return "127." + std::to_string(1 + pid / 250 % 250) + "." + std::to_string(1 + pid % 250) + "." +
         std::to_string(1 + count++ % 250);
}

}  // namespace binpick
