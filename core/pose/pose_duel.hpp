// Which of two poses of one part the frame speaks for. Where both predict the same, only noise
// decides: nothing is counted there. What counts is surface, free space and outline that one
// predicts and the other does not.
#pragma once

#include <array>
#include <cstdint>

#include "binpick/model/object_model.hpp"
#include "pose/scene.hpp"

namespace binpick {

// What a pose predicts around a place in the image, on a coarse grid. About 50 KB, for the stack.
struct PosePrediction {
  static constexpr int kCells = 72;  // along each side
  struct Cell {
    float depth_mm = 0;  // 0: nothing of the part here
    float facing = 0;    // cosine between the surface's normal and the ray
  };
  std::array<Cell, kCells * kCells> cells;
  std::array<std::uint8_t, kCells * kCells> edges;  // directions of contours at or beside a cell
};

// The grid that two poses share: cells of `step` pixels of the depth level.
struct PredictionGrid {
  int left = 0, top = 0, step = 1;

  // Covers a part whose middle is at `middle_cam`, however it is turned.
  PredictionGrid(const ObjectModel& model, const Scene& scene, const Vec3& middle_cam);
};

void predict(const ObjectModel& model, const Scene& scene, const PredictionGrid& grid,
             const Pose& T_cam_centre, PosePrediction& out);

// Log odds of pose a against pose b, from their predictions: positive where the frame shows a.
double duel(const ObjectModel& model, const Scene& scene, const PredictionGrid& grid, const Pose& a,
            const PosePrediction& prediction_a, const Pose& b, const PosePrediction& prediction_b);

}  // namespace binpick
