// The half of Sensor that makes frames.
#include <algorithm>

#include "binpick/base/assert.hpp"
#include "region.hpp"
#include "sensor.hpp"

namespace binpick::sim {
namespace {

// Images of one component that are kept: a loop over a few scenes then costs only their sending.
constexpr std::size_t kEncodedMax = 96;
constexpr std::size_t kCutMax = 16;

}  // namespace

std::vector<Component> Sensor::enabled_components() const {
  std::vector<Component> enabled;
  for (const Component component : {kRange, kIntensity, kConfidence}) {
    if (registers_.u32(kComponentEnable + 4 * component) != 0) enabled.push_back(component);
  }
  return enabled;
}

Scan3dValues Sensor::scan3d_values() const {
  Scan3dValues values;
  values.output_mode = registers_.u32(kOutputMode);
  for (std::uint32_t i = 0; i < kCoordinateCount; ++i) {
    values.scale[i] = registers_.f64(kCoordinateScale + 8 * i);
    values.offset[i] = registers_.f64(kCoordinateOffset + 8 * i);
  }
  values.invalid_value = registers_.f64(kInvalidDataValue + 8 * kCoordinateC);
  values.baseline_m = registers_.f64(kBaseline);
  return values;
}

ChunkValues Sensor::chunk_values(const SceneFrame& frame) const {
  ChunkValues values;
  values.image_id = static_cast<std::uint32_t>(frame.image_id);
  values.output_mode = registers_.u32(kOutputMode);
  values.distance_unit = registers_.u32(kDistanceUnit);
  values.focal_length_px = registers_.f64(kFocalLength);
  values.principal_point_u_px = registers_.f64(kPrincipalPointU);
  values.principal_point_v_px = registers_.f64(kPrincipalPointV);
  values.baseline_m = registers_.f64(kBaseline);
  values.aspect_ratio = registers_.f64(kAspectRatio);
  for (std::uint32_t i = 0; i < kCoordinateCount; ++i) {
    values.scale[i] = registers_.f64(kCoordinateScale + 8 * i);
    values.offset[i] = registers_.f64(kCoordinateOffset + 8 * i);
    values.invalid_flag[i] = registers_.u32(kInvalidDataFlag + 4 * i);
    values.invalid_value[i] = registers_.f64(kInvalidDataValue + 8 * i);
  }
  return values;
}

std::size_t Sensor::chunk_byte_count() const {
  if (registers_.u32(kChunkModeActive) == 0) return 0;
  std::size_t bytes = 8;
  for (std::uint32_t i = kChunkTimestamp; i < kChunkCount; ++i) {
    if (registers_.u32(kChunkEnable + 4 * i) != 0)
      bytes += 8 + static_cast<std::size_t>(chunk_size(static_cast<Chunk>(i)));
  }
  return bytes;
}

// The largest block that a host has to have room for.
void Sensor::update_payload_size(bool multipart) {
  multipart_ = multipart;
  const std::size_t pixels =
      std::size_t{registers_.u32(kWidth)} * std::size_t{registers_.u32(kHeight)};
  std::size_t sum = 0, largest = 0;
  for (const Component component : enabled_components()) {
    const PixelEncoder* encoder =
        find_encoder(registers_.u32(kPixelFormat + 4 * component), component);
    BINPICK_ASSERT(encoder != nullptr);
    const std::size_t bytes = pixels * static_cast<std::size_t>(encoder->bytes_per_pixel);
    sum += bytes;
    largest = std::max(largest, bytes);
  }
  registers_.set_u32(kPayloadSize,
                     static_cast<std::uint32_t>((multipart ? sum : largest) + chunk_byte_count()));
}

SharedBytes Sensor::encoded(const std::shared_ptr<const SceneFrame>& frame, Component component,
                            const PixelEncoder& encoder) {
  for (const Encoded& entry : encoded_) {
    if (entry.image_id == frame->image_id && entry.component == component &&
        entry.format == encoder.format) {
      return entry.bytes;
    }
  }
  auto bytes = std::make_shared<std::vector<std::uint8_t>>(
      static_cast<std::size_t>(frame->width) * static_cast<std::size_t>(frame->height) *
      static_cast<std::size_t>(encoder.bytes_per_pixel));
  encoder.encode(*frame, scan3d_values(), *bytes);
  if (encoded_.size() >= kEncodedMax) encoded_.erase(encoded_.begin());
  encoded_.push_back({frame->image_id, component, encoder.format, bytes});
  return bytes;
}

std::shared_ptr<const SceneFrame> Sensor::view(int index) {
  const auto side = [&](std::uint64_t address) {
    return static_cast<int>(registers_.u32(address));
  };
  const Region region{side(kOffsetX), side(kOffsetY), side(kWidth), side(kHeight)};
  const int image_id = scenes_.image_id(index);
  for (const auto& kept : cut_) {
    if (kept->image_id == image_id) return kept;
  }
  std::shared_ptr<const SceneFrame> whole = scenes_.frame(index);
  if (region.width == whole->width && region.height == whole->height) return whole;
  if (cut_.size() >= kCutMax) cut_.erase(cut_.begin());
  cut_.push_back(std::make_shared<const SceneFrame>(cut_out(*whole, region)));
  return cut_.back();
}

std::vector<SensorFrame> Sensor::expose(std::uint64_t index, std::uint64_t first_id,
                                        std::uint64_t timestamp_ns, bool multipart) {
  const std::lock_guard guard(mutex_);
  const auto count = static_cast<std::uint64_t>(scenes_.count());
  const std::shared_ptr<const SceneFrame> scene = view(static_cast<int>(index % count));
  store_camera(*scene);
  std::vector<SensorFrame> frames;
  for (const Component component : enabled_components()) {
    if (frames.empty() || !multipart) {
      SensorFrame frame;
      frame.id = first_id + frames.size();
      frame.timestamp_ns = timestamp_ns;
      frame.image_id = scene->image_id;
      frame.width = scene->width;
      frame.height = scene->height;
      frame.offset_x = registers_.u32(kOffsetX);
      frame.offset_y = registers_.u32(kOffsetY);
      frames.push_back(std::move(frame));
    }
    const std::uint32_t format = registers_.u32(kPixelFormat + 4 * component);
    const PixelEncoder* encoder = find_encoder(format, component);
    BINPICK_ASSERT(encoder != nullptr);
    frames.back().parts.push_back({component, registers_.u32(kComponentId + 4 * component), format,
                                   encoded(scene, component, *encoder)});
  }
  if (registers_.u32(kChunkModeActive) == 0) return frames;
  bool enabled[kChunkCount];
  for (std::uint32_t i = 0; i < kChunkCount; ++i)
    enabled[i] = registers_.u32(kChunkEnable + 4 * i) != 0;
  ChunkValues values = chunk_values(*scene);
  values.timestamp_ns = timestamp_ns;
  for (SensorFrame& frame : frames) {
    values.frame_id = frame.id;
    values.component_id = frame.parts.front().component_id;
    frame.chunks =
        chunk_bytes(values, frame.byte_count(), enabled, registers_.order(), registers_.order());
  }
  return frames;
}

void Sensor::warm_up() {
  const int count = std::min(scenes_.count(), 16);
  for (int i = 0; i < count; ++i) expose(static_cast<std::uint64_t>(i), 1, 0, true);
  const std::lock_guard guard(mutex_);
  store_camera(*view(0));
}

}  // namespace binpick::sim
