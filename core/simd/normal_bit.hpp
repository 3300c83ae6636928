// The orientation bin of a surface normal, by its components (nx, ny) in the frame of its own
// viewing ray. The bins are the directions of largest dot product around a ring, and where the
// codebook has it a cell that faces the camera.
#pragma once

#include <cstdint>

#include "binpick/model/normal_codebook.hpp"

namespace binpick {

// The cell that faces the camera ends at this tilt; chosen so that the eight cells of a convex part
// cover about the same projected area (sin^2 = 1/8).
inline constexpr float kFacingTiltSin = 0.354f;
// Below this tilt an azimuth is noise: the paper's codebook gives no orientation.
inline constexpr float kAzimuthTiltSinMin = 0.05f;

struct NormalCells {
  float tilt_sin2_min;      // below it: `facing` instead of a cell of the ring
  std::uint8_t facing;      // bits
  std::uint8_t first_ring;  // bit of the cell around azimuth 0; the others follow from +x to +y
  int ring;                 // cells
  float cosine[8], sine[8];
};

inline constexpr NormalCells kAzimuthCells = {
    kAzimuthTiltSinMin * kAzimuthTiltSinMin,
    0,
    1,
    8,
    {1, 0.70710678f, 0, -0.70710678f, -1, -0.70710678f, 0, 0.70710678f},
    {0, 0.70710678f, 1, 0.70710678f, 0, -0.70710678f, -1, -0.70710678f}};
inline constexpr NormalCells kHemisphereCells = {
    kFacingTiltSin * kFacingTiltSin,
    1,
    2,
    7,
    {1, 0.62348980f, -0.22252093f, -0.90096887f, -0.90096887f, -0.22252093f, 0.62348980f},
    {0, 0.78183148f, 0.97492791f, 0.43388374f, -0.43388374f, -0.97492791f, -0.78183148f}};

inline constexpr const NormalCells& normal_cells(NormalCodebook codebook) {
  return codebook == NormalCodebook::kAzimuth ? kAzimuthCells : kHemisphereCells;
}

// Of directions equally near the first one.
inline std::uint8_t normal_bit(NormalCodebook codebook, float nx, float ny) {
  const NormalCells& cells = normal_cells(codebook);
  if (nx * nx + ny * ny < cells.tilt_sin2_min) return cells.facing;
  int nearest = 0;
  float best = nx;
  for (int k = 1; k < cells.ring; ++k) {
    const float along = nx * cells.cosine[k] + ny * cells.sine[k];
    if (along > best) {
      best = along;
      nearest = k;
    }
  }
  return static_cast<std::uint8_t>(cells.first_ring << nearest);
}

}  // namespace binpick
