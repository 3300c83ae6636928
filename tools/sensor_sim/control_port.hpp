// Lines that steer a simulator while it runs, from standard input and from a Unix socket. Each
// line gets one line back: "ok", "ok TEXT" or "err REASON".
// Thread: the one that polls.
#pragma once

#include <poll.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace binpick::sim {

class ControlPort {
 public:
  // The answer, without its line end.
  using Handler = std::function<std::string(const std::string& line)>;

  // `socket_path`: empty for standard input alone. Throws std::runtime_error when it cannot be
  // made; a socket that nobody serves any more is replaced.
  ControlPort(const std::string& socket_path, Handler handler);
  ~ControlPort();  // removes the socket
  ControlPort(const ControlPort&) = delete;
  ControlPort& operator=(const ControlPort&) = delete;

  void add_descriptors(std::vector<pollfd>& descriptors) const;
  // Takes in what poll found at any of the descriptors.
  void serve(const std::vector<pollfd>& descriptors);

 private:
  struct Source {
    int out = -1;
    std::string text;  // up to the next line end
  };
  void accept_client();
  bool read_lines(int descriptor, Source& source);

  std::string path_;
  Handler handler_;
  int listener_ = -1;
  std::map<int, Source> sources_;  // by descriptor
};

}  // namespace binpick::sim
