#include "gvcp_socket.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>
#include <stdexcept>
#include <string>

namespace binpick::sim {
namespace {

constexpr std::uint16_t kGvcpPort = 3956;

int open_at(in_addr address) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return -1;
  const int yes = 1;
  // Several sensors of one machine hear the same broadcasts.
  if (address.s_addr == INADDR_BROADCAST || (ntohl(address.s_addr) & 0xff) == 0xff)
    setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in local{};
  local.sin_family = AF_INET;
  local.sin_port = htons(kGvcpPort);
  local.sin_addr = address;
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&local), sizeof local) == 0)
    return descriptor;
  const int reason = errno;
  close(descriptor);
  errno = reason;
  return -1;
}

// Where hosts of the sensor's network broadcast to.
std::set<std::uint32_t> broadcast_addresses(in_addr address) {
  std::set<std::uint32_t> found = {INADDR_BROADCAST};
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return found;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET ||
        entry->ifa_netmask == nullptr) {
      continue;
    }
    const auto ip_of = [](const sockaddr* generic) {
      sockaddr_in inet;
      std::memcpy(&inet, generic, sizeof inet);
      return inet.sin_addr.s_addr;
    };
    const std::uint32_t mask = ip_of(entry->ifa_netmask);
    if ((ip_of(entry->ifa_addr) & mask) == (address.s_addr & mask))
      found.insert(address.s_addr | ~mask);
  }
  freeifaddrs(list);
  found.erase(address.s_addr);  // a mask of all bits
  return found;
}

}  // namespace

GvcpSockets::GvcpSockets(in_addr address, GvcpServer& server, const FaultBoard& faults)
    : server_(server), faults_(faults), unicast_(open_at(address)) {
  if (unicast_ < 0) {
    throw std::runtime_error(std::string(inet_ntoa(address)) + " port " +
                             std::to_string(kGvcpPort) + ": " + std::strerror(errno));
  }
  for (const std::uint32_t broadcast : broadcast_addresses(address)) {
    const int descriptor = open_at({broadcast});
    // Without it the sensor is not found by search, but still answers at its address.
    if (descriptor >= 0) broadcast_.push_back(descriptor);
  }
}

GvcpSockets::~GvcpSockets() {
  close(unicast_);
  for (const int descriptor : broadcast_) close(descriptor);
}

void GvcpSockets::add_descriptors(std::vector<pollfd>& descriptors) const {
  descriptors.push_back({unicast_, POLLIN, 0});
  for (const int descriptor : broadcast_) descriptors.push_back({descriptor, POLLIN, 0});
}

void GvcpSockets::serve(const std::vector<pollfd>& descriptors) {
  for (const pollfd& entry : descriptors) {
    if (entry.revents == 0) continue;
    const bool ours = entry.fd == unicast_ ||
                      std::find(broadcast_.begin(), broadcast_.end(), entry.fd) != broadcast_.end();
    if (ours) serve_one(entry.fd);
  }
}

void GvcpSockets::serve_one(int descriptor) {
  std::uint8_t request[2048];
  while (true) {
    sockaddr_in host{};
    socklen_t host_size = sizeof host;
    const ssize_t size = recvfrom(descriptor, request, sizeof request, 0,
                                  reinterpret_cast<sockaddr*>(&host), &host_size);
    if (size < 0) return;
    if (faults_.on(kFrozen)) continue;
    const std::vector<std::uint8_t> answer =
        server_.answer({request, static_cast<std::size_t>(size)}, host);
    if (answer.empty()) continue;
    // Answers come from the sensor's own address, those to broadcasts too.
    sendto(unicast_, answer.data(), answer.size(), 0, reinterpret_cast<const sockaddr*>(&host),
           host_size);
  }
}

}  // namespace binpick::sim
