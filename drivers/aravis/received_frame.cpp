#include "aravis/received_frame.hpp"

#include "genicam/chunk_chain.hpp"

namespace binpick::drivers {
namespace {

// ComponentIDValue as the naming convention numbers them.
enum ComponentId : unsigned { kIntensity = 1, kRange = 4, kConfidence = 6, kDisparity = 8 };

bool is_image(ArvBufferPartDataType type) {
  return type == ARV_BUFFER_PART_DATA_TYPE_2D_IMAGE || type == ARV_BUFFER_PART_DATA_TYPE_3D_IMAGE ||
         type == ARV_BUFFER_PART_DATA_TYPE_CONFIDENCE_MAP;
}

PixelFormat format_of(std::uint32_t number, const ReceivedFrame::Rules& rules) {
  const auto own = rules.formats.find(number);
  return own != rules.formats.end() ? own->second : pixel_format_from_number(number);
}

// By what the pixels are; where that says nothing (Mono16 may be anything), by the component.
PartRole role_of(PixelFormat format, unsigned component, ArvBufferPartDataType type,
                 bool mono16_is_depth) {
  if (is_coord3d(format)) return PartRole::kDepth;
  if (is_confidence(format)) return PartRole::kConfidence;
  if (component == kRange || component == kDisparity) return PartRole::kDepth;
  if (component == kConfidence) return PartRole::kConfidence;
  if (component == kIntensity) return PartRole::kIntensity;
  if (type == ARV_BUFFER_PART_DATA_TYPE_3D_IMAGE) return PartRole::kDepth;
  if (type == ARV_BUFFER_PART_DATA_TYPE_CONFIDENCE_MAP) return PartRole::kConfidence;
  if (component != 0) return PartRole::kOther;
  if (format == PixelFormat::kMono16 && mono16_is_depth) return PartRole::kDepth;
  return PartRole::kIntensity;
}

// Bytes of an image with its padding after each row.
std::size_t image_bytes(const PayloadPart& part) {
  return (row_bytes(part.format, part.width) + part.x_padding_bytes) *
         static_cast<std::size_t>(part.height);
}

// What was received is the one image, or the chain of chunks that begins with it.
bool single_image_complete(ArvBuffer* buffer, const PayloadPart& part,
                           std::span<const std::uint8_t> received,
                           const ReceivedFrame::Rules& rules) {
  if (arv_buffer_has_chunks(buffer) == FALSE) return received.size() == image_bytes(part);
  const ByteOrder order = rules.big_endian_chunks ? ByteOrder::kBig : ByteOrder::kLittle;
  return received.size() > image_bytes(part) && chunks_fill(received, order);
}

}  // namespace

DropReason ReceivedFrame::read_part(ArvBuffer* buffer, unsigned index,
                                    std::span<const std::uint8_t> received, const Rules& rules) {
  const ArvBufferPartDataType type = arv_buffer_get_part_data_type(buffer, index);
  if (!is_image(type)) return DropReason::kNone;
  PayloadPart& part = parts_[part_count_];
  part = {};
  part.format = format_of(arv_buffer_get_part_pixel_format(buffer, index), rules);
  part.role = role_of(part.format, arv_buffer_get_part_component_id(buffer, index), type,
                      rules.mono16_is_depth);
  if (part.role == PartRole::kOther) return DropReason::kNone;
  int x_padding = 0, y_padding = 0;
  arv_buffer_get_part_region(buffer, index, nullptr, nullptr, &part.width, &part.height);
  arv_buffer_get_part_padding(buffer, index, &x_padding, &y_padding);
  if (part.width <= 0 || part.height <= 0 || part.width > 65535 || part.height > 65535 ||
      x_padding < 0 || x_padding > 65535)
    return DropReason::kSize;
  part.x_padding_bytes = static_cast<std::size_t>(x_padding);
  std::size_t part_bytes = 0;
  const void* data = arv_buffer_get_part_data(buffer, index, &part_bytes);
  const std::size_t offset =
      static_cast<std::size_t>(static_cast<const std::uint8_t*>(data) - received.data());
  if (offset > received.size() || part_bytes > received.size() - offset)
    return DropReason::kPartBounds;
  if (row_bytes(part.format, part.width) == 0) return DropReason::kFormat;
  part.bytes = received.subspan(offset, part_bytes);
  // Larger is as wrong as smaller: the announced width and height are then not those of the bytes.
  if (part_bytes < image_bytes(part)) return DropReason::kPartBounds;
  ++part_count_;
  return DropReason::kNone;
}

DropReason ReceivedFrame::read(ArvBuffer* buffer, std::size_t buffer_bytes, const Rules& rules) {
  part_count_ = 0;
  if (arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SIZE_MISMATCH)
    return DropReason::kShortPayload;
  if (arv_buffer_get_status(buffer) != ARV_BUFFER_STATUS_SUCCESS) return DropReason::kIncomplete;
  std::size_t received_bytes = 0;
  const void* data = arv_buffer_get_data(buffer, &received_bytes);
  if (received_bytes > buffer_bytes) return DropReason::kShortPayload;
  const std::span received(static_cast<const std::uint8_t*>(data), received_bytes);
  bytes_ = received;

  const unsigned count = arv_buffer_get_n_parts(buffer);
  if (count == 0) return DropReason::kFormat;
  if (count > static_cast<unsigned>(kPartsMax)) return DropReason::kFormat;
  std::size_t announced_bytes = 0;
  for (unsigned i = 0; i < count; ++i) {
    std::size_t part_bytes = 0;
    arv_buffer_get_part_data(buffer, i, &part_bytes);
    if (part_bytes > buffer_bytes) return DropReason::kPartBounds;
    announced_bytes += part_bytes;
  }
  const bool multipart = arv_buffer_get_payload_type(buffer) == ARV_BUFFER_PAYLOAD_TYPE_MULTIPART;
  if (multipart && announced_bytes > buffer_bytes) return DropReason::kPartBounds;
  if (multipart && announced_bytes != received_bytes) return DropReason::kShortPayload;
  for (unsigned i = 0; i < count; ++i) {
    const DropReason reason = read_part(buffer, i, received, rules);
    if (reason == DropReason::kPartBounds && !multipart) return DropReason::kShortPayload;
    if (reason != DropReason::kNone) return reason;
  }
  if (part_count_ == 0) return DropReason::kNoDepth;
  if (multipart) {
    for (const PayloadPart& part : parts()) {
      if (part.bytes.size() != image_bytes(part)) return DropReason::kSize;
    }
    return DropReason::kNone;
  }
  return single_image_complete(buffer, parts_[0], received, rules) ? DropReason::kNone
                                                                   : DropReason::kShortPayload;
}

}  // namespace binpick::drivers
