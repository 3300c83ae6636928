// A Unix stream socket on which people and scripts give orders: a line in, a line out, see
// control_text.hpp. Who may open it is the folder's and the file's permissions. A client has one
// order under way; it is answered when the station has carried it out. Thread: main; driven by
// poll().
#pragma once

#include <poll.h>

#include <array>
#include <functional>
#include <span>
#include <string>

#include "daemon/control_text.hpp"

namespace binpick::app {

class ControlSocket {
 public:
  static constexpr int kClientsMax = 8;
  static constexpr std::size_t kLineMax = 512;
  static constexpr std::size_t kDescriptorsMax = 1 + kClientsMax;

  struct Handlers {
    std::function<bool(const Order&)> offer;  // false: one is waiting already
    std::function<std::string()> status;      // JSON
    std::function<bool()> record;             // false: there is no recorder
  };

  // Makes the socket at `path`, replacing one that nobody listens on. Empty: none. Throws
  // SetupError.
  ControlSocket(const std::string& path, Handlers handlers);
  ~ControlSocket();
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;

  // What is to be polled; returns how many there are. Allocates nothing.
  std::size_t put_descriptors(std::span<pollfd, kDescriptorsMax> descriptors) const;
  void handle(std::span<const pollfd> descriptors);
  // Answers whoever waits for the order with the result's sequence.
  void answer(const CycleResult& result);

 private:
  struct Client {
    int descriptor = -1;
    std::string input;
    std::uint32_t waits_for = 0;  // sequence of the order; 0: none
  };

  void accept_client();
  void read_from(Client& client);
  void serve_lines(Client& client);
  std::string reply_to(Client& client, std::string_view line);
  void send(Client& client, std::string line);
  void drop(Client& client);

  std::string path_;
  Handlers handlers_;
  int listener_ = -1;
  std::uint32_t sequence_ = 0;
  std::array<Client, kClientsMax> clients_;
};

}  // namespace binpick::app
