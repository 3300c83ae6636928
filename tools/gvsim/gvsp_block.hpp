// A frame cut into the packets of the GigE Vision Stream Protocol. Any packet can be built at any
// time, for sending and for sending again; image data are pointed at, not copied.
// Thread-safe: immutable.
#pragma once

#include <sys/uio.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sensor.hpp"

namespace binpick::sim {

struct GvspFormat {
  std::uint32_t packet_size = 1400;  // with IP, UDP and GVSP headers, as GevSCPSPacketSize has it
  bool extended_ids = true;
  bool multipart = true;  // only with extended ids
};

// What a leader or the packets say that is not so.
struct GvspLies {
  bool offset = false, size = false, width = false, height = false;
};

// One packet: a head of its own and the image data behind it.
struct GvspPacket {
  static constexpr std::size_t kHeadMax = 256;
  std::uint8_t head[kHeadMax];
  std::size_t head_bytes = 0;
  iovec pieces[3];  // the first is the head
  std::size_t piece_count = 0;

  void begin(std::size_t bytes);  // pieces = the head alone
  void append(const std::uint8_t* data, std::size_t bytes);
  std::size_t byte_count() const;
};

class GvspBlock {
 public:
  GvspBlock(const SensorFrame& frame, const GvspFormat& format, const GvspLies& lies);

  std::uint64_t id() const { return id_; }
  std::uint32_t packet_count() const { return packet_count_; }  // with leader and trailer
  const GvspFormat& format() const { return format_; }
  // `number` below packet_count(): 0 is the leader, the last is the trailer. The packet points
  // into this block.
  void build(std::uint32_t number, GvspPacket& packet) const;

 private:
  struct Segment {  // of the data, in order
    const std::uint8_t* data;
    std::size_t bytes;
    std::uint32_t first_packet;  // multipart: its first data packet
  };
  void header(GvspPacket& packet, std::uint32_t number, unsigned content, unsigned low_bits) const;
  void build_leader(GvspPacket& packet) const;
  void build_trailer(GvspPacket& packet) const;
  void build_multipart_data(std::uint32_t number, GvspPacket& packet) const;
  void build_data(std::uint32_t number, GvspPacket& packet) const;
  std::uint16_t payload_type() const;

  const SensorFrame frame_;
  const GvspFormat format_;
  const GvspLies lies_;
  std::uint64_t id_ = 0;
  std::size_t bytes_per_packet_ = 0;
  std::uint32_t packet_count_ = 0;
  std::vector<Segment> segments_;
};

// The packet that says that another cannot be sent again.
void build_unavailable_packet(std::uint64_t block_id, std::uint32_t number, bool extended_ids,
                              GvspPacket& packet);

// Bytes of IP and UDP headers, which GevSCPSPacketSize counts.
constexpr std::size_t kUdpOverhead = 28;

}  // namespace binpick::sim
