#include "detect/detection_of.hpp"

#include "pose/uncertainty.hpp"

namespace binpick {
namespace {

Pose in_object_frame(const ObjectModel& model, const Pose& T_cam_centre) {
  return {T_cam_centre.R, T_cam_centre.t_mm - T_cam_centre.R * model.centre_mm()};
}

void add_alternatives_of(const Hypothesis& h, const ObjectModel& model, Detection& d) {
  const double own = odds_alone(h), all = own + h.ambiguity.odds;
  d.pose_probability = own / all;
  for (const Hypothesis* other : h.ambiguity.best) {
    if (other == nullptr) break;
    d.alternatives[static_cast<std::size_t>(d.alternative_count++)] = {
        in_object_frame(model, other->T_cam_centre), odds_alone(*other) / all};
  }
}

}  // namespace

Detection detection_of(const PoseContext& context, const Hypothesis& h) {
  const ObjectModel& model = context.models[h.candidate.model];
  const Scene& scene = context.scene;
  Detection d;
  d.model_index = h.candidate.model;
  d.T_cam_obj = in_object_frame(model, h.T_cam_centre);
  d.score_terms = terms_of(h);
  d.uncertainty = pose_uncertainty(model, scene, h.T_cam_centre);
  d.score = h.score;
  d.symmetric = context.symmetries[h.candidate.model].has_any(context.near_symmetry);
  add_alternatives_of(h, model, d);
  d.visible_fraction = h.evidence.visible_fraction();
  d.depth_support = h.evidence.depth_support();
  d.contour_support = h.evidence.contour_support();
  d.depth_residual_mm = depth_residual_mm(model, scene, h.T_cam_centre);
  d.template_score = static_cast<double>(h.candidate.score) / kScoreOne;
  const TreeDepth& leaves = model.depth(model.depth_count() - 1);
  d.template_index =
      (h.candidate.viewpoint * leaves.roll_count + h.candidate.roll) * leaves.distance_count +
      h.candidate.distance;
  return d;
}

}  // namespace binpick
