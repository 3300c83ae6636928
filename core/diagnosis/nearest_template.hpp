// The template that shows a part as it stands at a known pose, and how well it matches there.
#pragma once

#include <optional>

#include "pose/ray_pose.hpp"
#include "search/scale_plan.hpp"
#include "simd/kernel_table.hpp"

namespace binpick {

struct TemplateContext {
  const ObjectModel& model;
  int model_index;
  const ScalePlan& plan;
  const FeaturePyramid& pyramid;
  const simd::KernelTable& kernels;
};

// The node of tree depth `depth` (at least the scan depth) nearest to the pose, at the pixel of its
// pyramid level where the template matches best within two pixels of the pose's centre; its score
// is what the search would see. Nothing where no distance near the pose's is searched, or the
// centre lies outside the region.
std::optional<Candidate> nearest_template(const TemplateContext& context, int depth,
                                          const Pose& T_cam_centre);

}  // namespace binpick
