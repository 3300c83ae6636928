// What refinement and verification look up instead of rendering: for each leaf viewpoint, points of
// the visible surface with normals, and points of the outline and of sharp visible creases with
// their directions.
#pragma once

#include <vector>

#include "binpick/model/object_model.hpp"
#include "train/sample_pool.hpp"

namespace binpick::train {

// Object coordinates; the direction of a surface sample is its outward normal, that of a contour
// sample runs along the edge. Unit vectors.
struct PointSample {
  float position_mm[3];
  float direction[3];
};

struct ViewSamples {
  std::vector<PointSample> surface;  // in an order in which any prefix is spread over all of it
  std::vector<PointSample> contour;  // the outline first, then creases
  int outline_count = 0;
  double sample_area_mm2 = 0;  // projected area that one surface sample stands for
};

inline constexpr int kOutlineSamplesMax = 128;
inline constexpr int kCreaseSamplesMax = kContourSamplesMax - kOutlineSamplesMax;

// One entry per leaf viewpoint, in order.
std::vector<ViewSamples> make_view_samples(const Mesh& centred_mesh, const PoseTree& tree,
                                           const TemplateCamera& camera, WorkerPool& pool);

}  // namespace binpick::train
