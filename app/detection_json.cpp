#include "detection_json.hpp"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "binpick/geometry/angle.hpp"

namespace binpick::app {
namespace {

using nlohmann::ordered_json;

ordered_json matrix_rows(const Pose& T) {
  ordered_json rows = ordered_json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({T.R(r, 0), T.R(r, 1), T.R(r, 2), T.t_mm(r)});
  rows.push_back({0.0, 0.0, 0.0, 1.0});
  return rows;
}

// Of the part's centre, in camera axes.
ordered_json to_json(const PoseUncertainty& u) {
  const auto axis = [](const Vec3& v) { return ordered_json{v.x(), v.y(), v.z()}; };
  return {{"shift_mm", u.weak_shift_mm},
          {"shift_axis", axis(u.weak_shift)},
          {"shift_observable", u.shift_observable},
          {"turn_deg", u.weak_turn_rad / kDegree},
          {"turn_axis", axis(u.weak_turn)},
          {"turn_observable", u.turn_observable},
          {"covariance_rad_mm", u.covariance}};
}

ordered_json alternatives_json(const Detection& d) {
  auto json = ordered_json::array();
  for (const PoseAlternative& a :
       std::span(d.alternatives).first(static_cast<std::size_t>(d.alternative_count)))
    json.push_back({{"T_cam_obj", matrix_rows(a.T_cam_obj)}, {"probability", a.probability}});
  return json;
}

ordered_json to_json(const Detection& d, std::span<const std::string> model_names) {
  return {{"model", model_names[static_cast<std::size_t>(d.model_index)]},
          {"model_index", d.model_index},
          {"score", d.score},
          {"symmetric", d.symmetric},
          {"pose_probability", d.pose_probability},
          {"pose_ambiguous", pose_ambiguous(d)},
          {"alternatives", alternatives_json(d)},
          {"T_cam_obj", matrix_rows(d.T_cam_obj)},
          {"quaternion_wxyz", quaternion_wxyz(d.T_cam_obj.R)},
          {"translation_mm", {d.T_cam_obj.t_mm.x(), d.T_cam_obj.t_mm.y(), d.T_cam_obj.t_mm.z()}},
          {"visible_fraction", d.visible_fraction},
          {"depth_support", d.depth_support},
          {"contour_support", d.contour_support},
          {"depth_residual_mm", d.depth_residual_mm},
          {"uncertainty", to_json(d.uncertainty)},
          {"template_score", d.template_score},
          {"template_index", d.template_index}};
}

}  // namespace

std::array<double, 4> quaternion_wxyz(const Mat3& R) {
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return {q.w(), q.x(), q.y(), q.z()};
}

ordered_json to_json(const DetectionReport& report, std::span<const std::string> model_names) {
  ordered_json json;
  json["detections"] = ordered_json::array();
  for (const Detection& d : report.detections) {
    json["detections"].push_back(to_json(d, model_names));
  }
  if (report.best_rejected) {
    json["best_rejected"] = to_json(report.best_rejected->pose, model_names);
    json["best_rejected"]["reason"] = drop_reason_name(report.best_rejected->reason);
  }
  json["total_ms"] = report.total_ms;
  json["cut_short"] = report.cut_short;
  for (int i = 0; i < kStageCount; ++i) {
    json["stage_ms"][stage_name(static_cast<Stage>(i))] = report.stage_ms[i];
  }
  json["levels"] = ordered_json::array();
  for (int d = 0; d < report.level_count; ++d) {
    json["levels"].push_back({{"depth", d},
                              {"templates_evaluated", report.templates_evaluated[d]},
                              {"candidates", report.candidates[d]},
                              {"ms", report.level_ms[d]}});
  }
  for (int i = 0; i < kDropReasonCount; ++i) {
    json["dropped"][drop_reason_name(static_cast<DropReason>(i))] = report.dropped[i];
  }
  return json;
}

}  // namespace binpick::app
