// The sockets of the control channel: one at the sensor's own address, and one for each address to
// which hosts broadcast their search for sensors.
// Thread: the one that polls.
#pragma once

#include <netinet/in.h>
#include <poll.h>

#include <vector>

#include "gvcp_server.hpp"

namespace binpick::sim {

class GvcpSockets {
 public:
  // Throws std::runtime_error when the address cannot be had.
  GvcpSockets(in_addr address, GvcpServer& server, const FaultBoard& faults);
  ~GvcpSockets();
  GvcpSockets(const GvcpSockets&) = delete;
  GvcpSockets& operator=(const GvcpSockets&) = delete;

  void add_descriptors(std::vector<pollfd>& descriptors) const;
  void serve(const std::vector<pollfd>& descriptors);

 private:
  void serve_one(int descriptor);

  GvcpServer& server_;
  const FaultBoard& faults_;
  int unicast_ = -1;
  std::vector<int> broadcast_;
};

}  // namespace binpick::sim
