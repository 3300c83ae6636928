#include "modbus/address_list.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>

#include "setup_error.hpp"

namespace binpick::modbus {
namespace {

std::uint32_t mask_of(int prefix_bits) {
  return prefix_bits == 0 ? 0 : ~std::uint32_t{0} << (32U - static_cast<unsigned>(prefix_bits));
}

}  // namespace

bool Network::contains(std::uint32_t other) const {
  return (other & mask_of(prefix_bits)) == address;
}

std::uint32_t parse_address(const std::string& text) {
  in_addr address{};
  if (::inet_pton(AF_INET, text.c_str(), &address) != 1) {
    throw app::SetupError("'" + text + "' is no IPv4 address");
  }
  return ntohl(address.s_addr);
}

Network parse_network(const std::string& text) {
  const auto slash = text.find('/');
  if (slash == std::string::npos) return {parse_address(text), 32};
  Network network{parse_address(text.substr(0, slash)), 0};
  const char* begin = text.data() + slash + 1;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(begin, end, network.prefix_bits);
  if (begin == end || parsed.ptr != end || parsed.ec != std::errc{} || network.prefix_bits < 0 ||
      network.prefix_bits > 32) {
    throw app::SetupError("'" + text + "': the part after / is a number from 0 to 32");
  }
  if ((network.address & ~mask_of(network.prefix_bits)) != 0) {
    throw app::SetupError("'" + text + "' has bits set beyond its prefix");
  }
  return network;
}

std::string address_text(std::uint32_t address) {
  char text[INET_ADDRSTRLEN];
  const in_addr network_order{htonl(address)};
  return ::inet_ntop(AF_INET, &network_order, text, sizeof text) != nullptr ? text : "?";
}

bool allowed(std::span<const Network> networks, std::uint32_t address) {
  return networks.empty() ||
         std::any_of(networks.begin(), networks.end(),
                     [&](const Network& network) { return network.contains(address); });
}

}  // namespace binpick::modbus
