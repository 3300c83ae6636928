#include "assess/assess_json.hpp"

#include <nlohmann/json.hpp>

#include "binpick/geometry/angle.hpp"
#include "detection_json.hpp"

namespace binpick::app {
namespace {

using nlohmann::ordered_json;

// Of right ones, as the interval of wrong ones.
ordered_json wrong_json(const RightShare& seen) {
  return {{"count", seen.count},
          {"not_found_again", seen.count - seen.right},
          {"interval", {1 - seen.high(), 1 - seen.low()}}};
}

ordered_json picks_json(const WrongPicks& p) {
  return {{"threshold", p.threshold},
          {"wrong_picks", p.share()},
          {"by_score", p.by_score},
          {"poses", wrong_json(p.poses)},
          {"parts", wrong_json(p.parts)}};
}

// By direction; null where the values say nothing.
template <class Value>
ordered_json by_direction(Value&& value) {
  ordered_json out;
  constexpr const char* kKeys[kDirectionCount] = {"x_mm",   "y_mm",   "z_mm",
                                                  "rx_deg", "ry_deg", "rz_deg"};
  for (int d = 0; d < kDirectionCount; ++d) out[kKeys[d]] = value(d);
  return out;
}

ordered_json spread_json(const Repeatability& r) {
  if (r.count < 2) return nullptr;
  const auto observable = [&r](const auto& values) {
    return by_direction([&](int d) {
      const auto i = static_cast<std::size_t>(d);
      return r.unobservable[i] ? ordered_json() : ordered_json(values[i]);
    });
  };
  return {{"measured", observable(r.sigma)}, {"claimed", observable(r.claimed)}};
}

ordered_json part_json(const AssessedPart& part) {
  const Pose& T = part.track.mean;
  return {{"number", part.number},
          {"centre_mm", {T.t_mm.x(), T.t_mm.y(), T.t_mm.z()}},
          {"quaternion_wxyz", quaternion_wxyz(T.R)},
          {"frames_in_view", part.frames},
          {"found", part.found},
          {"found_at_threshold", part.accepted},
          {"found_share", part.found_share()},
          {"found_share_at_threshold", part.accepted_share()},
          {"median_score", part.median_score},
          {"flips", part.flips},
          {"same_place_as", part.same_place > 0 ? ordered_json(part.same_place) : ordered_json()},
          {"standard_deviation", spread_json(part.repeatability)}};
}

ordered_json model_json(const ModelAssessment& model) {
  const DirectionSummary& s = model.spread;
  const auto values = [](const auto& of) {
    return by_direction([&of](int d) { return ordered_json(of[static_cast<std::size_t>(d)]); });
  };
  ordered_json out{{"model", model.name}};
  out["suggested"] = model.suggested ? picks_json(*model.suggested) : ordered_json();
  out["at_threshold"] = picks_json(model.at_threshold);
  out["repeatability"] = ordered_json();
  if (model.spread_parts > 0)
    out["repeatability"] = {{"parts", model.spread_parts},
                            {"median", values(s.median)},
                            {"worst", values(s.worst)},
                            {"claimed_over_measured", by_direction([&s](int d) {
                               const double claim = s.claim[static_cast<std::size_t>(d)];
                               return claim > 0 ? ordered_json(claim) : ordered_json();
                             })}};
  out["score_histogram"] = {{"all", model.scores.all}, {"found_again", model.scores.found_again}};
  out["limits"] = ordered_json::array();
  for (const LimitFinding& finding : model.limits)
    out["limits"].push_back({{"cause", score_limit_name(finding.limit)},
                             {"parts", finding.parts},
                             {"log_odds", finding.cost},
                             {"text", finding.text}});
  out["parts"] = ordered_json::array();
  for (const AssessedPart& part : model.parts) out["parts"].push_back(part_json(part));
  out["other_poses"] = {{"count", model.passing_poses}, {"score_max", model.passing_score_max}};
  return out;
}

}  // namespace

ordered_json assessment_json(const Assessment& a) {
  ordered_json out{
      {"frames", a.frames},
      {"reference", a.reference},
      {"threshold", a.settings.threshold},
      {"wrong_picks_max", a.settings.wrong_picks_max},
      {"moved", a.settings.moved},
      {"near_symmetry", kNearSymmetryNames[static_cast<int>(a.settings.near_symmetry)]},
      {"notes", a.notes},
      {"time_ms",
       {{"p50", 1e3 * a.time.p50_s}, {"p99", 1e3 * a.time.p99_s}, {"max", 1e3 * a.time.max_s}}}};
  out["depth_noise_mm"] = a.noise_mm > 0 ? ordered_json(a.noise_mm) : ordered_json();
  if (a.settings.moved) {
    out["refused"] = a.refused;
    out["motions"] = ordered_json::array();
    for (const FrameMotion& f : a.motions)
      out["motions"].push_back({{"frame", f.name},
                                {"shift_mm", f.motion.shift_mm},
                                {"rotation_deg", f.motion.angle_rad / kDegree},
                                {"poses_that_agree", f.motion.agreeing},
                                {"poses_compared", f.motion.compared},
                                {"next_best", f.motion.next_best}});
  }
  out["models"] = ordered_json::array();
  for (const ModelAssessment& model : a.models) out["models"].push_back(model_json(model));
  return out;
}

}  // namespace binpick::app
