#include "detect/detection_of.hpp"

#include "pose/uncertainty.hpp"

namespace binpick {

Detection detection_of(std::span<const ObjectModel> models, const Scene& scene,
                       const Hypothesis& h) {
  const ObjectModel& model = models[h.candidate.model];
  Detection d;
  d.model_index = h.candidate.model;
  d.T_cam_obj = h.T_cam_centre;
  d.T_cam_obj.t_mm -= h.T_cam_centre.R * model.centre_mm();
  d.score_terms = terms_of(h);
  d.uncertainty = pose_uncertainty(model, scene, h.T_cam_centre);
  d.score = h.score;
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
