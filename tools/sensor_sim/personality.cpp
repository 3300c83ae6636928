#include "personality.hpp"

#include "pixel_encoder.hpp"

namespace binpick::sim {
namespace {

constexpr Personality kPersonalities[] = {
    {.name = "c16",
     .description = "Coord3D_C16 z-depth as the codes of the PNG, and Mono8, multipart",
     .range_format = kCoord3dC16,
     .intensity_format = kMono8,
     .confidence_format = kConfidence16},
    {.name = "disparity",
     .description = "as rc_visard: Coord3D_C16 disparity and Mono8, with chunks",
     .range_format = kCoord3dC16,
     .intensity_format = kMono8,
     .confidence_format = kConfidence8,
     .output_mode = kDisparityC,
     .distance_unit = kPixel,
     .chunks_active = true,
     .scale_c = 0.0625,
     .baseline_m = 0.16,
     .range_component = "Disparity",
     .range_component_id = 8},
    {.name = "abcy16",
     .description = "as Helios2: Coord3D_ABCY16 in a single part, invalid 65535",
     .range_format = kCoord3dAbcy16,
     .intensity_format = kMono16,
     .confidence_format = kConfidence16,
     .enabled = {true, false, false},
     .output_mode = kCalibratedAbcGrid,
     .invalid_value = 65535},
    {.name = "mono16-c32f",
     .description = "as Photoneo: Mono16 intensity and Coord3D_C32f, multipart",
     .range_format = kCoord3dC32f,
     .intensity_format = kMono16,
     .confidence_format = kConfidence8,
     .scale_c = 1},
    {.name = "abc32f",
     .description = "as blaze: Coord3D_ABC32f, Mono16 and Confidence16, multipart",
     .range_format = kCoord3dAbc32f,
     .intensity_format = kMono16,
     .confidence_format = kConfidence16,
     .enabled = {true, true, true},
     .output_mode = kCalibratedAbcGrid,
     .scale_c = 1},
    {.name = "mono16",
     .description = "as blaze: Mono16 z-depth and Mono16 intensity, multipart",
     .range_format = kMono16,
     .intensity_format = kMono16,
     .confidence_format = kConfidence16},
};

}  // namespace

std::span<const Personality> personalities() {
  return kPersonalities;
}

const Personality* find_personality(const std::string& name) {
  for (const Personality& personality : kPersonalities) {
    if (name == personality.name) return &personality;
  }
  return nullptr;
}

}  // namespace binpick::sim
