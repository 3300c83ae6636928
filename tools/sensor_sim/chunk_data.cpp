#include "chunk_data.hpp"

namespace binpick::sim {
namespace {

struct ChunkKind {
  const char* name;
  int bytes;
};

constexpr ChunkKind kKinds[kChunkCount] = {
    {"Image", 0},
    {"Timestamp", 8},
    {"FrameID", 8},
    {"ComponentIDValue", 4},
    {"ImageID", 4},
    {"Scan3dOutputMode", 4},
    {"Scan3dDistanceUnit", 4},
    {"Scan3dFocalLength", 8},
    {"Scan3dPrincipalPointU", 8},
    {"Scan3dPrincipalPointV", 8},
    {"Scan3dBaseline", 8},
    {"Scan3dAspectRatio", 8},
    {"Scan3dCoordinateScale", 8 * kCoordinateCount},
    {"Scan3dCoordinateOffset", 8 * kCoordinateCount},
    {"Scan3dInvalidDataFlag", 4 * kCoordinateCount},
    {"Scan3dInvalidDataValue", 8 * kCoordinateCount},
};

class ChunkWriter {
 public:
  ChunkWriter(ByteOrder order, ByteOrder tag_order) : order_(order), tag_order_(tag_order) {}

  void u32(std::uint32_t value) { append(value, order_); }
  void u64(std::uint64_t value) { append(value, order_); }
  void f64(double value) { append(bits_of(value), order_); }
  void f64(const std::array<double, kCoordinateCount>& values) {
    for (const double value : values) f64(value);
  }
  void tag(Chunk chunk, std::size_t length) {
    append(static_cast<std::uint32_t>(chunk) + 1, tag_order_);
    append(static_cast<std::uint32_t>(length), tag_order_);
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  template <class T>
  void append(T value, ByteOrder order) {
    std::uint8_t text[sizeof(T)];
    put(text, value, order);
    bytes_.insert(bytes_.end(), text, text + sizeof(T));
  }

  ByteOrder order_, tag_order_;
  std::vector<std::uint8_t> bytes_;
};

void write_value(ChunkWriter& writer, Chunk chunk, const ChunkValues& values) {
  switch (chunk) {
    case kChunkTimestamp:
      return writer.u64(values.timestamp_ns);
    case kChunkFrameId:
      return writer.u64(values.frame_id);
    case kChunkComponentId:
      return writer.u32(values.component_id);
    case kChunkImageId:
      return writer.u32(values.image_id);
    case kChunkOutputMode:
      return writer.u32(values.output_mode);
    case kChunkDistanceUnit:
      return writer.u32(values.distance_unit);
    case kChunkFocalLength:
      return writer.f64(values.focal_length_px);
    case kChunkPrincipalPointU:
      return writer.f64(values.principal_point_u_px);
    case kChunkPrincipalPointV:
      return writer.f64(values.principal_point_v_px);
    case kChunkBaseline:
      return writer.f64(values.baseline_m);
    case kChunkAspectRatio:
      return writer.f64(values.aspect_ratio);
    case kChunkCoordinateScale:
      return writer.f64(values.scale);
    case kChunkCoordinateOffset:
      return writer.f64(values.offset);
    case kChunkInvalidDataFlag:
      for (const std::uint32_t flag : values.invalid_flag) writer.u32(flag);
      return;
    case kChunkInvalidDataValue:
      return writer.f64(values.invalid_value);
    case kChunkImage:
    case kChunkCount:
      return;
  }
}

}  // namespace

const char* chunk_name(Chunk chunk) {
  return kKinds[chunk].name;
}

int chunk_size(Chunk chunk) {
  return kKinds[chunk].bytes;
}

std::vector<std::uint8_t> chunk_bytes(const ChunkValues& values, std::size_t image_bytes,
                                      std::span<const bool> enabled, ByteOrder order,
                                      ByteOrder tag_order) {
  ChunkWriter writer(order, tag_order);
  writer.tag(kChunkImage, image_bytes);
  for (std::uint32_t i = kChunkTimestamp; i < kChunkCount; ++i) {
    const auto chunk = static_cast<Chunk>(i);
    if (!enabled[i]) continue;
    write_value(writer, chunk, values);
    writer.tag(chunk, static_cast<std::size_t>(chunk_size(chunk)));
  }
  return writer.take();
}

}  // namespace binpick::sim
