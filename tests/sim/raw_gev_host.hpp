// A GigE Vision host of bare datagrams, which sees what a library hides: status codes and packets.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace binpick {

struct GvcpAnswer {
  int status = 0;
  int command = 0;
  std::vector<std::uint8_t> payload;
};

struct StreamPacket {
  std::uint16_t status = 0;
  int content = 0;  // 1 leader, 2 trailer, 3 payload, 7 multipart payload
  bool extended_ids = false;
  int part_count = 0;  // of a leader
  std::uint64_t block_id = 0;
  std::uint32_t number = 0;
  std::uint64_t offset = 0;           // of a multipart payload
  std::vector<std::uint8_t> payload;  // behind all headers
};

class RawGevHost {
 public:
  explicit RawGevHost(const std::string& address);
  ~RawGevHost();
  RawGevHost(const RawGevHost&) = delete;
  RawGevHost& operator=(const RawGevHost&) = delete;

  // Nothing when no answer came within the time.
  std::optional<GvcpAnswer> command(std::uint16_t number, const std::vector<std::uint8_t>& payload,
                                    std::uint8_t flags = 1, int timeout_ms = 10000);
  std::optional<std::uint32_t> read(std::uint32_t address);
  int read_status(std::uint32_t address);
  int write(std::uint32_t address, std::uint32_t value);  // the status; -1: no answer

  // Takes control, sets the packet size, opens the stream and starts acquisition on triggers.
  void start(std::uint32_t packet_size);
  void trigger();
  void ask_again(std::uint64_t block_id, std::uint32_t first, std::uint32_t last);

  // What comes until nothing has come for `quiet_ms`; waits `first_ms` for the first.
  std::vector<StreamPacket> packets(int first_ms = 10000, int quiet_ms = 200);

 private:
  int control_ = -1, stream_ = -1;
  std::uint16_t stream_port_ = 0, request_id_ = 0;
  sockaddr_in sensor_{};
};

std::vector<std::uint8_t> big_endian(const std::vector<std::uint32_t>& words);

}  // namespace binpick
