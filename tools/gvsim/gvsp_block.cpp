#include "gvsp_block.hpp"

#include <algorithm>
#include <cstring>

#include "binpick/base/assert.hpp"
#include "byte_order.hpp"

namespace binpick::sim {
namespace {

constexpr std::size_t kStandardHeader = 8;
constexpr std::size_t kExtendedHeader = 20;
constexpr std::size_t kPartHeader = 8;  // of a multipart data packet
constexpr std::size_t kPartInfo = 48;   // of a part in the leader
constexpr std::uint16_t kStatusUnavailable = 0x800c;

enum Content : unsigned { kLeader = 1, kTrailer = 2, kPayload = 3, kMultipartPayload = 7 };
enum PayloadType : std::uint16_t { kImage = 0x0001, kMultipart = 0x000a, kWithChunks = 0x4000 };
enum PartDataType : std::uint16_t {
  kPart2dImage = 0x0001,
  kPart3dImage = 0x0005,
  kPartConfidence = 0x0009,
  kPartChunks = 0x000a,
};

std::uint16_t part_data_type(Component component) {
  switch (component) {
    case kRange:
      return kPart3dImage;
    case kConfidence:
      return kPartConfidence;
    default:
      return kPart2dImage;
  }
}

std::size_t put_header(std::uint8_t* out, std::uint16_t status, std::uint64_t block_id,
                       std::uint32_t number, bool extended_ids, unsigned content,
                       unsigned low_bits) {
  put_be16(out, status);
  if (!extended_ids) {
    put_be16(out + 2, static_cast<std::uint16_t>(block_id));
    put_be32(out + 4, content << 24 | (number & 0xffffff));
    return kStandardHeader;
  }
  put_be16(out + 2, 0);
  put_be32(out + 4, 0x80000000u | content << 24 | low_bits);
  put_be64(out + 8, block_id);
  put_be32(out + 16, number);
  return kExtendedHeader;
}

}  // namespace

void GvspPacket::begin(std::size_t bytes) {
  BINPICK_ASSERT(bytes <= kHeadMax);
  head_bytes = bytes;
  pieces[0] = {head, head_bytes};
  piece_count = 1;
}

void GvspPacket::append(const std::uint8_t* data, std::size_t bytes) {
  if (bytes == 0) return;
  pieces[piece_count++] = {const_cast<std::uint8_t*>(data), bytes};  // iovec knows no const
}

std::size_t GvspPacket::byte_count() const {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < piece_count; ++i) bytes += pieces[i].iov_len;
  return bytes;
}

GvspBlock::GvspBlock(const SensorFrame& frame, const GvspFormat& format, const GvspLies& lies)
    : frame_(frame), format_(format), lies_(lies) {
  BINPICK_ASSERT(format_.extended_ids || !format_.multipart);
  // Block id 0 means a test packet, so 16-bit ids go from 65535 to 1.
  id_ = format_.extended_ids ? frame_.id : (frame_.id - 1) % 65535 + 1;
  const std::size_t header = format_.extended_ids ? kExtendedHeader : kStandardHeader;
  bytes_per_packet_ =
      format_.packet_size - kUdpOverhead - header - (format_.multipart ? kPartHeader : 0);
  for (const FramePart& part : frame_.parts)
    segments_.push_back({part.bytes->data(), part.bytes->size(), 0});
  if (!frame_.chunks.empty()) segments_.push_back({frame_.chunks.data(), frame_.chunks.size(), 0});
  const auto packets_of = [&](std::size_t bytes) {
    return static_cast<std::uint32_t>((bytes + bytes_per_packet_ - 1) / bytes_per_packet_);
  };
  std::uint32_t next = 1;
  for (Segment& segment : segments_) {
    segment.first_packet = next;
    next += packets_of(segment.bytes);
  }
  packet_count_ = (format_.multipart ? next : 1 + packets_of(frame_.byte_count())) + 1;
}

std::uint16_t GvspBlock::payload_type() const {
  const unsigned type = format_.multipart ? kMultipart : kImage;
  return static_cast<std::uint16_t>(frame_.chunks.empty() ? type : type | kWithChunks);
}

void GvspBlock::header(GvspPacket& packet, std::uint32_t number, unsigned content,
                       unsigned low_bits) const {
  packet.begin(put_header(packet.head, 0, id_, number, format_.extended_ids, content, low_bits));
}

void GvspBlock::build_leader(GvspPacket& packet) const {
  const auto parts = static_cast<unsigned>(segments_.size());
  header(packet, 0, kLeader, format_.multipart ? parts : 0);
  std::uint8_t* out = packet.head + packet.head_bytes;
  std::memset(out, 0, GvspPacket::kHeadMax - packet.head_bytes);
  put_be16(out + 2, payload_type());
  put_be64(out + 4, frame_.timestamp_ns);
  out += 12;
  const auto width = static_cast<std::uint32_t>(frame_.width) * (lies_.width ? 2 : 1);
  const auto height = static_cast<std::uint32_t>(frame_.height) * (lies_.height ? 2 : 1);
  if (!format_.multipart) {
    put_be32(out, frame_.parts.front().pixel_format);
    put_be32(out + 4, width);
    put_be32(out + 8, height);
    put_be32(out + 12, frame_.offset_x);
    put_be32(out + 16, frame_.offset_y);
    packet.begin(packet.head_bytes + 12 + 24);
    return;
  }
  for (std::size_t i = 0; i < segments_.size(); ++i, out += kPartInfo) {
    const bool is_chunks = i >= frame_.parts.size();
    const std::uint64_t bytes = segments_[i].bytes * (lies_.size && i == 0 ? 2 : 1);
    put_be16(out,
             is_chunks ? std::uint16_t{kPartChunks} : part_data_type(frame_.parts[i].component));
    put_be16(out + 2, static_cast<std::uint16_t>(bytes >> 32));
    put_be32(out + 4, static_cast<std::uint32_t>(bytes));
    if (is_chunks) continue;
    put_be32(out + 8, frame_.parts[i].pixel_format);
    put_be16(out + 20, static_cast<std::uint16_t>(frame_.parts[i].component_id));
    put_be32(out + 24, width);
    put_be32(out + 28, height);
    put_be32(out + 32, frame_.offset_x);
    put_be32(out + 36, frame_.offset_y);
  }
  packet.begin(packet.head_bytes + 12 + kPartInfo * segments_.size());
}

void GvspBlock::build_trailer(GvspPacket& packet) const {
  header(packet, packet_count_ - 1, kTrailer, 0);
  std::uint8_t* out = packet.head + packet.head_bytes;
  put_be16(out, 0);
  put_be16(out + 2, payload_type());
  put_be32(out + 4, static_cast<std::uint32_t>(frame_.height));
  packet.begin(packet.head_bytes + 8);
}

// A packet carries data of one part only, and says where in the block they belong.
void GvspBlock::build_multipart_data(std::uint32_t number, GvspPacket& packet) const {
  std::size_t part = 0, offset = 0;
  while (part + 1 < segments_.size() && segments_[part + 1].first_packet <= number)
    offset += segments_[part++].bytes;
  const Segment& segment = segments_[part];
  const std::size_t inside = (number - segment.first_packet) * bytes_per_packet_;
  header(packet, number, kMultipartPayload, 0);
  std::uint8_t* out = packet.head + packet.head_bytes;
  const std::uint64_t claimed = offset + inside + (lies_.offset ? frame_.byte_count() : 0);
  out[0] = static_cast<std::uint8_t>(part);
  out[1] = 0;
  put_be16(out + 2, static_cast<std::uint16_t>(claimed >> 32));
  put_be32(out + 4, static_cast<std::uint32_t>(claimed));
  packet.begin(packet.head_bytes + kPartHeader);
  packet.append(segment.data + inside, std::min(bytes_per_packet_, segment.bytes - inside));
}

void GvspBlock::build_data(std::uint32_t number, GvspPacket& packet) const {
  header(packet, number, kPayload, 0);
  std::size_t begin = (number - 1) * bytes_per_packet_;
  std::size_t left = std::min(bytes_per_packet_, frame_.byte_count() - begin);
  for (const Segment& segment : segments_) {
    if (begin >= segment.bytes) {
      begin -= segment.bytes;
      continue;
    }
    const std::size_t bytes = std::min(left, segment.bytes - begin);
    packet.append(segment.data + begin, bytes);
    left -= bytes;
    begin = 0;
    if (left == 0) break;
  }
}

void GvspBlock::build(std::uint32_t number, GvspPacket& packet) const {
  BINPICK_ASSERT(number < packet_count_);
  if (number == 0) {
    build_leader(packet);
  } else if (number == packet_count_ - 1) {
    build_trailer(packet);
  } else if (format_.multipart) {
    build_multipart_data(number, packet);
  } else {
    build_data(number, packet);
  }
}

void build_unavailable_packet(std::uint64_t block_id, std::uint32_t number, bool extended_ids,
                              GvspPacket& packet) {
  packet.begin(put_header(packet.head, kStatusUnavailable, block_id, number, extended_ids,
                          extended_ids ? kMultipartPayload : kPayload, 0));
}

}  // namespace binpick::sim
