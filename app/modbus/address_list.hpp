// Which clients may connect: IPv4 addresses and networks, as "192.168.0.10" or "192.168.0.0/24".
// Thread-safe: nothing changes after construction.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace binpick::modbus {

struct Network {
  std::uint32_t address = 0;  // host byte order, bits beyond the prefix 0
  int prefix_bits = 32;

  bool contains(std::uint32_t other) const;
};

// Throws app::SetupError naming the text: no address, a prefix beyond 32, or bits set beyond it.
Network parse_network(const std::string& text);
std::uint32_t parse_address(const std::string& text);  // host byte order
std::string address_text(std::uint32_t address);

// An empty list lets everybody in.
bool allowed(std::span<const Network> networks, std::uint32_t address);

}  // namespace binpick::modbus
