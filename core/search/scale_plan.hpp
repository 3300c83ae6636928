// At which pyramid level, and how much enlarged, the templates of a model apply to a frame. A
// template is stored as seen by the model's camera from the reference distance; another distance or
// focal length is a change of scale, and a factor of two is a change of level.
#pragma once

#include "binpick/frame/frame.hpp"
#include "binpick/model/object_model.hpp"

namespace binpick {

// Templates are enlarged by at most this much, and shrunk to no less than the other.
inline constexpr double kTemplateScaleMax = 2.0;
inline constexpr double kTemplateScaleMin = 0.35;

struct ScalePlan {
  // [depth][distance]; level -1: this distance cannot be searched in this frame
  std::int8_t level[kModelDepthsMax][kModelDistancesMax];
  std::int16_t scale_q8[kModelDepthsMax][kModelDistancesMax];
};

// Distances at which the part's image is too large or too small for its templates are left out;
// fails with kModelCameraMismatch where none is left.
Result<ScalePlan> make_scale_plan(const ObjectModel& model, const CameraIntrinsics& camera,
                                  int level_count);

// Scale (template px to level px) and level for a model at one distance.
double template_scale(const ObjectModel& model, const CameraIntrinsics& camera, double distance_mm);

// The finest level that the model is searched at.
int finest_level(const ObjectModel& model, const ScalePlan& plan);

}  // namespace binpick
