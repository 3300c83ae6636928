// Clients that do what a server must survive, each on a thread of its own, until they are
// destroyed.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace binpick::modbus {

class HostileClients {
 public:
  // Begins frames and leaves them; drips bytes; asks without reading; sends frames that are wrong
  // in every way; connects and goes, as fast as it can.
  explicit HostileClients(int port);
  ~HostileClients();
  HostileClients(const HostileClients&) = delete;
  HostileClients& operator=(const HostileClients&) = delete;

 private:
  void stall();
  void drip();
  void flood();
  void talk_nonsense();
  void reconnect();

  int port_;
  std::atomic<bool> stopping_{false};
  std::vector<std::thread> threads_;
};

}  // namespace binpick::modbus
