#include "raw_gev_host.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace binpick {
namespace {

std::uint64_t number_at(const std::vector<std::uint8_t>& bytes, std::size_t at, int size) {
  std::uint64_t value = 0;
  for (int i = 0; i < size; ++i) value = value << 8 | bytes.at(at + static_cast<std::size_t>(i));
  return value;
}

bool comes(int descriptor, int timeout_ms) {
  pollfd entry{descriptor, POLLIN, 0};
  return poll(&entry, 1, timeout_ms) > 0;
}

std::vector<std::uint8_t> receive(int descriptor) {
  std::vector<std::uint8_t> bytes(65536);
  const ssize_t count = recv(descriptor, bytes.data(), bytes.size(), 0);
  bytes.resize(count < 0 ? 0 : static_cast<std::size_t>(count));
  return bytes;
}

StreamPacket parse(const std::vector<std::uint8_t>& bytes) {
  StreamPacket packet;
  packet.status = static_cast<std::uint16_t>(number_at(bytes, 0, 2));
  const auto infos = static_cast<std::uint32_t>(number_at(bytes, 4, 4));
  packet.extended_ids = infos >> 31 != 0;
  packet.content = infos >> 24 & 0x7f;
  std::size_t header = 8;
  if (packet.extended_ids) {
    packet.part_count = static_cast<int>(infos & 0xff);
    packet.block_id = number_at(bytes, 8, 8);
    packet.number = static_cast<std::uint32_t>(number_at(bytes, 16, 4));
    header = 20;
  } else {
    packet.block_id = number_at(bytes, 2, 2);
    packet.number = infos & 0xffffff;
  }
  if (packet.content == 7 && packet.status == 0) {
    packet.offset = number_at(bytes, header + 2, 6);
    header += 8;
  }
  packet.payload.assign(bytes.begin() + static_cast<std::ptrdiff_t>(header), bytes.end());
  return packet;
}

}  // namespace

std::vector<std::uint8_t> big_endian(const std::vector<std::uint32_t>& words) {
  std::vector<std::uint8_t> bytes;
  for (const std::uint32_t word : words) {
    for (int shift = 24; shift >= 0; shift -= 8)
      bytes.push_back(static_cast<std::uint8_t>(word >> shift));
  }
  return bytes;
}

RawGevHost::RawGevHost(const std::string& address) {
  control_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  stream_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in local{};
  local.sin_family = AF_INET;
  local.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  bind(control_, reinterpret_cast<sockaddr*>(&local), sizeof local);
  bind(stream_, reinterpret_cast<sockaddr*>(&local), sizeof local);
  socklen_t size = sizeof local;
  getsockname(stream_, reinterpret_cast<sockaddr*>(&local), &size);
  stream_port_ = ntohs(local.sin_port);
  sensor_.sin_family = AF_INET;
  sensor_.sin_port = htons(3956);
  inet_pton(AF_INET, address.c_str(), &sensor_.sin_addr);
}

RawGevHost::~RawGevHost() {
  close(control_);
  close(stream_);
}

std::optional<GvcpAnswer> RawGevHost::command(std::uint16_t number,
                                              const std::vector<std::uint8_t>& payload,
                                              std::uint8_t flags, int timeout_ms) {
  ++request_id_;
  const auto high = [](std::size_t value) { return static_cast<std::uint8_t>(value >> 8); };
  const auto low = [](std::size_t value) { return static_cast<std::uint8_t>(value); };
  std::vector<std::uint8_t> request = {0x42,
                                       flags,
                                       high(number),
                                       low(number),
                                       high(payload.size()),
                                       low(payload.size()),
                                       high(request_id_),
                                       low(request_id_)};
  request.insert(request.end(), payload.begin(), payload.end());
  sendto(control_, request.data(), request.size(), 0, reinterpret_cast<const sockaddr*>(&sensor_),
         sizeof sensor_);
  while (comes(control_, timeout_ms)) {
    const std::vector<std::uint8_t> bytes = receive(control_);
    if (bytes.size() < 8 || number_at(bytes, 6, 2) != request_id_) continue;
    return GvcpAnswer{static_cast<int>(number_at(bytes, 0, 2)),
                      static_cast<int>(number_at(bytes, 2, 2)),
                      {bytes.begin() + 8, bytes.end()}};
  }
  return std::nullopt;
}

std::optional<std::uint32_t> RawGevHost::read(std::uint32_t address) {
  const auto answer = command(0x80, big_endian({address}));
  if (!answer || answer->status != 0) return std::nullopt;
  return static_cast<std::uint32_t>(number_at(answer->payload, 0, 4));
}

int RawGevHost::read_status(std::uint32_t address) {
  const auto answer = command(0x80, big_endian({address}));
  return answer ? answer->status : -1;
}

int RawGevHost::write(std::uint32_t address, std::uint32_t value) {
  const auto answer = command(0x82, big_endian({address, value}));
  return answer ? answer->status : -1;
}

void RawGevHost::start(std::uint32_t packet_size) {
  write(0x0a00, 2);
  write(0x0d04, packet_size);
  write(0x0d18, INADDR_LOOPBACK);
  write(0x0d00, stream_port_);
  write(0x10018, 1);  // trigger mode; the source is software at start
  write(0x1002c, 1);
}

void RawGevHost::trigger() {
  write(0x10024, 1);
}

void RawGevHost::ask_again(std::uint64_t block_id, std::uint32_t first, std::uint32_t last) {
  command(0x40,
          big_endian({0, first, last, static_cast<std::uint32_t>(block_id >> 32),
                      static_cast<std::uint32_t>(block_id)}),
          0x10, 0);
}

std::vector<StreamPacket> RawGevHost::packets(int first_ms, int quiet_ms) {
  std::vector<StreamPacket> all;
  while (comes(stream_, all.empty() ? first_ms : quiet_ms)) all.push_back(parse(receive(stream_)));
  return all;
}

}  // namespace binpick
