// The chunks that follow an image: which there are, and their bytes. Each chunk is its data
// followed by its id and length; the image itself is the first chunk. Thread-safe: functions of
// their arguments.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "byte_order.hpp"
#include "feature_map.hpp"

namespace binpick::sim {

// In the order of ChunkSelector's values; the id at the wire is the value + 1.
enum Chunk : std::uint32_t {
  kChunkImage,
  kChunkTimestamp,
  kChunkFrameId,
  kChunkComponentId,
  kChunkImageId,
  kChunkOutputMode,
  kChunkDistanceUnit,
  kChunkFocalLength,
  kChunkPrincipalPointU,
  kChunkPrincipalPointV,
  kChunkBaseline,
  kChunkAspectRatio,
  kChunkCoordinateScale,
  kChunkCoordinateOffset,
  kChunkInvalidDataFlag,
  kChunkInvalidDataValue,
  kChunkCount,
};

struct ChunkValues {
  std::uint64_t timestamp_ns = 0;
  std::uint64_t frame_id = 0;
  std::uint32_t component_id = 0;
  std::uint32_t image_id = 0;  // of the scene
  std::uint32_t output_mode = 0, distance_unit = 0;
  double focal_length_px = 0, principal_point_u_px = 0, principal_point_v_px = 0;
  double baseline_m = 0, aspect_ratio = 1;
  std::array<double, kCoordinateCount> scale{}, offset{}, invalid_value{};
  std::array<std::uint32_t, kCoordinateCount> invalid_flag{};
};

// ChunkSelector's entry; the feature with the chunk's value is "Chunk" and this name.
const char* chunk_name(Chunk chunk);

// Bytes of the chunk's value; of the image 0.
int chunk_size(Chunk chunk);

// Everything behind the image: the image's own tag and then the enabled chunks with theirs. Values
// in `order`; ids and lengths in `tag_order`, which the transport prescribes.
std::vector<std::uint8_t> chunk_bytes(const ChunkValues& values, std::size_t image_bytes,
                                      std::span<const bool> enabled, ByteOrder order,
                                      ByteOrder tag_order);

}  // namespace binpick::sim
