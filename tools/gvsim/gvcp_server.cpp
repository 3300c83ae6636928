#include "gvcp_server.hpp"

#include <algorithm>

#include "byte_order.hpp"
#include "status_code.hpp"
#include "transport_registers.hpp"

namespace binpick::sim {
namespace {

constexpr std::size_t kHeader = 8;
constexpr std::size_t kMemoryMax = 536;  // bytes of one access
constexpr std::uint8_t kKey = 0x42;
constexpr std::uint8_t kFlagAcknowledge = 0x01;
constexpr std::uint8_t kFlagExtendedIds = 0x10;

enum Command : std::uint16_t {
  kDiscovery = 0x0002,
  kForceIp = 0x0004,
  kPacketResend = 0x0040,
  kReadRegister = 0x0080,
  kWriteRegister = 0x0082,
  kReadMemory = 0x0084,
  kWriteMemory = 0x0086,
};

// What an acknowledgement of a write says: how much of it was done.
std::vector<std::uint8_t> index_payload(std::size_t index) {
  std::vector<std::uint8_t> payload(4, 0);
  put_be16(payload.data() + 2, static_cast<std::uint16_t>(index));
  return payload;
}

}  // namespace

GvcpServer::Reply GvcpServer::discovery() {
  Reply reply{kSuccess, std::vector<std::uint8_t>(gev::kDiscoveryEnd)};
  reply.status = status_code(device_.read(0, reply.payload));
  return reply;
}

GvcpServer::Reply GvcpServer::read_registers(std::span<const std::uint8_t> payload,
                                             const sockaddr_in& host) {
  if (payload.empty() || payload.size() % 4 != 0 || payload.size() > kMemoryMax + 4)
    return {kInvalidHeader, {}};
  Reply reply;
  for (std::size_t i = 0; i < payload.size(); i += 4) {
    const std::uint32_t address = get_be32(&payload[i]);
    std::uint8_t value[4];
    reply.status = device_.may_read(host, address) == GevDevice::Verdict::kDenied
                       ? kAccessDenied
                       : status_code(device_.read(address, value));
    if (reply.status != kSuccess) break;  // with the values up to here
    reply.payload.insert(reply.payload.end(), value, value + 4);
  }
  return reply;
}

GvcpServer::Reply GvcpServer::write_registers(std::span<const std::uint8_t> payload,
                                              const sockaddr_in& host) {
  if (payload.empty() || payload.size() % 8 != 0) return {kInvalidHeader, index_payload(0)};
  for (std::size_t i = 0; i < payload.size(); i += 8) {
    const std::uint32_t address = get_be32(&payload[i]);
    const std::uint16_t status =
        device_.may_write(host, address) == GevDevice::Verdict::kDenied
            ? kAccessDenied
            : status_code(device_.write(host, address, payload.subspan(i + 4, 4)));
    if (status != kSuccess) return {status, index_payload(i / 8)};
  }
  return {kSuccess, index_payload(payload.size() / 8)};
}

GvcpServer::Reply GvcpServer::read_memory(std::span<const std::uint8_t> payload,
                                          const sockaddr_in& host) {
  if (payload.size() != 8) return {kInvalidHeader, {}};
  const std::uint32_t address = get_be32(payload.data());
  const std::size_t size = get_be16(payload.data() + 6);
  if (size == 0 || size > kMemoryMax) return {kInvalidParameter, {}};
  if (device_.may_read(host, address) == GevDevice::Verdict::kDenied) return {kAccessDenied, {}};
  Reply reply{kSuccess, std::vector<std::uint8_t>(4 + size)};
  std::copy_n(payload.begin(), 4, reply.payload.begin());
  reply.status = status_code(device_.read(address, std::span(reply.payload).subspan(4)));
  if (reply.status != kSuccess) reply.payload.clear();
  return reply;
}

GvcpServer::Reply GvcpServer::write_memory(std::span<const std::uint8_t> payload,
                                           const sockaddr_in& host) {
  if (payload.size() < 8 || payload.size() > 4 + kMemoryMax)
    return {kInvalidHeader, index_payload(0)};
  const std::uint32_t address = get_be32(payload.data());
  if (device_.may_write(host, address) == GevDevice::Verdict::kDenied)
    return {kAccessDenied, index_payload(0)};
  const auto bytes = payload.subspan(4);
  const std::uint16_t status = status_code(device_.write(host, address, bytes));
  return {status, index_payload(status == kSuccess ? bytes.size() : 0)};
}

void GvcpServer::packet_resend(std::span<const std::uint8_t> payload, bool extended_ids,
                               const sockaddr_in& host) {
  if (payload.size() != (extended_ids ? 20u : 12u)) return;
  const std::uint32_t first = get_be32(payload.data() + 4);
  const std::uint32_t last = get_be32(payload.data() + 8);
  if (extended_ids) {
    device_.resend(host, get_be64(payload.data() + 12), first, last, true);
  } else {
    device_.resend(host, get_be16(payload.data() + 2), first & 0xffffff, last & 0xffffff, false);
  }
}

std::vector<std::uint8_t> GvcpServer::answer(std::span<const std::uint8_t> request,
                                             const sockaddr_in& host) {
  if (request.size() < kHeader || request[0] != kKey) return {};
  const std::uint8_t flags = request[1];
  const std::uint16_t command = get_be16(&request[2]);
  const std::size_t size = get_be16(&request[4]);
  if (device_.controlled_by(host)) device_.heard();
  Reply reply;
  if (size != request.size() - kHeader) {
    reply.status = kInvalidHeader;
  } else {
    const auto payload = request.subspan(kHeader);
    switch (command) {
      case kDiscovery:
        reply = discovery();
        break;
      case kReadRegister:
        reply = read_registers(payload, host);
        break;
      case kWriteRegister:
        reply = write_registers(payload, host);
        break;
      case kReadMemory:
        reply = read_memory(payload, host);
        break;
      case kWriteMemory:
        reply = write_memory(payload, host);
        break;
      case kPacketResend:
        packet_resend(payload, (flags & kFlagExtendedIds) != 0, host);
        return {};    // the packets are the answer
      case kForceIp:  // the address is a matter of the command line
        reply.status = kAccessDenied;
        break;
      default:
        reply.status = kNotImplemented;
    }
  }
  if ((flags & kFlagAcknowledge) == 0) return {};
  std::vector<std::uint8_t> out(kHeader);
  put_be16(&out[0], reply.status);
  put_be16(&out[2], static_cast<std::uint16_t>(command + 1));
  put_be16(&out[4], static_cast<std::uint16_t>(reply.payload.size()));
  std::copy_n(request.begin() + 6, 2, out.begin() + 6);
  out.insert(out.end(), reply.payload.begin(), reply.payload.end());
  return out;
}

}  // namespace binpick::sim
