// What refinement and verification look up instead of rendering: for each leaf viewpoint, points of
// the visible surface with normals, and points of the outline and of sharp visible creases with
// their directions.
#pragma once

#include <vector>

#include "binpick/model/object_model.hpp"
#include "train/sample_pool.hpp"

namespace binpick::train {

struct ViewSamples {
  std::vector<SurfaceSample> surface;
  std::vector<ContourSample> contour;
  double sample_area_mm2 = 0;  // projected area that one surface sample stands for
};

inline constexpr int kSurfaceSamplesMax = 320;
inline constexpr int kSilhouetteSamplesMax = 128;
inline constexpr int kCreaseSamplesMax = 64;

// One entry per leaf viewpoint, in order.
std::vector<ViewSamples> make_view_samples(const Mesh& centred_mesh, const PoseTree& tree,
                                           const TemplateCamera& camera, WorkerPool& pool);

}  // namespace binpick::train
