#include "search/scale_plan.hpp"

#include <algorithm>
#include <cmath>

namespace binpick {

double template_scale(const ObjectModel& model, const CameraIntrinsics& camera,
                      double distance_mm) {
  const ModelInfo& info = model.info();
  const double focal = std::sqrt(camera.fx * camera.fy);
  const double focal_trained = std::sqrt(info.camera.fx * info.camera.fy);
  return (focal / distance_mm) / (focal_trained / info.reference_distance_mm);
}

Result<ScalePlan> make_scale_plan(const ObjectModel& model, const CameraIntrinsics& camera,
                                  int level_count) {
  ScalePlan plan{};
  const ModelInfo& info = model.info();
  int searchable_leaves = 0;
  const int leaf = model.depth_count() - 1;
  const int scan_depth = model.info().scan_depth;
  for (int d = scan_depth; d <= leaf; ++d) {
    for (int k = 0; k < model.depth(d).distance_count; ++k) {
      // All descendants of a scanned distance share its level.
      const double group_scale =
          template_scale(model, camera, model.distance_mm(scan_depth, k >> (d - scan_depth)));
      const int wanted =
          model.info().base_level + static_cast<int>(std::lround(std::log2(group_scale)));
      const int leaf_level = std::clamp(wanted, 0, level_count - 1 - (leaf - scan_depth));
      const double scale = template_scale(model, camera, model.distance_mm(d, k)) *
                           std::exp2(model.info().base_level - leaf_level);
      const bool searchable = scale >= kTemplateScaleMin && scale <= kTemplateScaleMax;
      searchable_leaves += searchable && d == leaf;
      plan.level[d][k] = static_cast<std::int8_t>(searchable ? leaf_level + leaf - d : -1);
      plan.scale_q8[d][k] = static_cast<std::int16_t>(std::lround(scale * 256));
    }
  }
  if (searchable_leaves == 0) {
    return Error{
        ErrorCode::kModelCameraMismatch,
        static_cast<long long>(100 * template_scale(model, camera, info.reference_distance_mm)),
        "percent of the trained image size"};
  }
  return plan;
}

int finest_level(const ObjectModel& model, const ScalePlan& plan) {
  int finest = kPyramidLevelsMax;
  for (int d = model.info().scan_depth; d < model.depth_count(); ++d) {
    for (int k = 0; k < model.depth(d).distance_count; ++k) {
      if (plan.level[d][k] >= 0) finest = std::min<int>(finest, plan.level[d][k]);
    }
  }
  return finest;
}

}  // namespace binpick
