// The GigE Vision Control Protocol: datagrams in, datagrams out.
// Thread: that of the device.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <span>
#include <vector>

#include "gev_device.hpp"

namespace binpick::sim {

class GvcpServer {
 public:
  explicit GvcpServer(GevDevice& device) : device_(device) {}

  // The answer; empty when there is none to give.
  std::vector<std::uint8_t> answer(std::span<const std::uint8_t> request, const sockaddr_in& host);

 private:
  struct Reply {
    std::uint16_t status = 0;
    std::vector<std::uint8_t> payload;
  };
  Reply discovery();
  Reply read_registers(std::span<const std::uint8_t> payload, const sockaddr_in& host);
  Reply write_registers(std::span<const std::uint8_t> payload, const sockaddr_in& host);
  Reply read_memory(std::span<const std::uint8_t> payload, const sockaddr_in& host);
  Reply write_memory(std::span<const std::uint8_t> payload, const sockaddr_in& host);
  void packet_resend(std::span<const std::uint8_t> payload, bool extended_ids,
                     const sockaddr_in& host);

  GevDevice& device_;
};

}  // namespace binpick::sim
