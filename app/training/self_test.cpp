#include "training/self_test.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "binpick/geometry/angle.hpp"
#include "eval/score.hpp"

namespace binpick::app {
namespace {

constexpr double kBandWidth = 0.1;
constexpr int kBandMin = 5;  // instances that a band must have to say anything
// Wrong poses are turned in place when their centre is this near to a part's, in diameters.
constexpr double kInPlace = 0.25;
// Turns that differ by less are the same confusion.
constexpr double kSameTurn_deg = 20;

std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string text(const char* format, ...) {
  char line[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  return line;
}

bool right(const ResultRow& row, const ScoredInstance& instance, const PartGeometry& geometry) {
  return is_right(geometry, row.T_cam_obj, instance.truth.T_cam_obj, PoseLimits{});
}

std::vector<VisibilityBand> find_bands(const PileTrial& trial, const PartGeometry& geometry,
                                       double threshold) {
  std::vector<VisibilityBand> bands;
  for (int i = 0; i < 10; ++i) bands.push_back({i * kBandWidth, (i + 1) * kBandWidth, 0, 0});
  for (const auto& [id, instances] : trial.truth) {
    for (const ScoredInstance& instance : instances) {
      if (!instance.origin_in_roi) continue;
      const int at = static_cast<int>(instance.truth.visible_fraction / kBandWidth);
      VisibilityBand& band = bands[static_cast<std::size_t>(std::clamp(at, 0, 9))];
      ++band.instances;
      band.found += std::any_of(trial.rows.begin(), trial.rows.end(), [&](const ResultRow& row) {
        return row.frame == id && row.score >= threshold && right(row, instance, geometry);
      });
    }
  }
  return bands;
}

// From here on up, half of the parts are found; 1 where that holds nowhere.
double visible_fraction_min(const std::vector<VisibilityBand>& bands) {
  double found_from = 1;
  int instances = 0, found = 0;  // of bands that say something only together
  for (auto band = bands.rbegin(); band != bands.rend(); ++band) {
    instances += band->instances;
    found += band->found;
    if (instances < kBandMin) continue;
    if (2 * found < instances) break;
    found_from = band->from;
    instances = found = 0;
  }
  return found_from;
}

void add_confusion(const Mat3& R_truth_estimate, std::vector<Confusion>& confusions) {
  const Eigen::AngleAxisd turn(R_truth_estimate);
  for (Confusion& known : confusions) {
    const Mat3 centre = Eigen::AngleAxisd(known.angle_deg * kDegree, known.axis).matrix();
    if (rotation_angle_between(centre, R_truth_estimate) / kDegree < kSameTurn_deg) {
      ++known.count;
      return;
    }
  }
  confusions.push_back({turn.axis(), turn.angle() / kDegree, 1});
}

void find_wrong(const PileTrial& trial, const PartGeometry& geometry, SelfTest& test) {
  for (const ResultRow& row : trial.rows) {
    if (row.score < test.threshold) continue;
    const ScoredInstance* in_place = nullptr;
    bool is_right = false;
    for (const ScoredInstance& instance : trial.truth.at(row.frame)) {
      is_right = is_right || right(row, instance, geometry);
      const double off_mm = (instance.truth.T_cam_obj.t_mm - row.T_cam_obj.t_mm).norm();
      if (off_mm < kInPlace * geometry.diameter_mm()) in_place = &instance;
    }
    if (is_right) continue;
    ++test.wrong;
    if (in_place == nullptr) continue;
    add_confusion(in_place->truth.T_cam_obj.R.transpose() * row.T_cam_obj.R, test.confusions);
  }
  std::stable_sort(test.confusions.begin(), test.confusions.end(),
                   [](const Confusion& a, const Confusion& b) { return a.count > b.count; });
}

}  // namespace

SelfTest judge(const PileTrial& trial, const PartGeometry& geometry, double threshold) {
  SelfTest test;
  test.threshold = threshold;
  ScoreOptions options;
  options.fixed_threshold = threshold;
  const ScoreReport report =
      score_results({{kPileObject, geometry}}, trial.truth, trial.rows, trial.time_s, options);
  const PartScore& part = report.parts.at(0);
  test.record.piles = static_cast<std::int32_t>(trial.truth.size());
  test.record.instances = part.instances;
  test.record.recall = part.fixed->recall;
  test.record.precision = part.fixed->precision;
  test.f1 = part.fixed->f1;
  if (part.mean_abs_error) {
    const PoseError6& e = *part.mean_abs_error;
    test.position_error_mm = (e[0] + e[1] + e[2]) / 3;
    test.angle_error_deg = (e[3] + e[4] + e[5]) / 3;
  }
  test.bands = find_bands(trial, geometry, threshold);
  test.record.visible_fraction_min = visible_fraction_min(test.bands);
  test.reliability = reliability_of(judged_poses(part, trial.rows), threshold);
  find_wrong(trial, geometry, test);
  return test;
}

std::vector<std::string> advice(const SelfTest& test, const ObjectModel& model) {
  constexpr double kPrecisionWanted = 0.98, kRecallWanted = 0.8;
  constexpr double kWidthWanted_px = 40;
  constexpr double kFlat = 0.12;
  const ModelInfo& info = model.info();
  std::vector<std::string> out;
  if (test.record.instances < 10) {
    out.push_back(
        text("only %d parts were mostly visible: the figures say little", test.record.instances));
  }
  const double width_px = info.diameter_mm * info.camera.fx / info.distance_max_mm;
  if (width_px < kWidthWanted_px) {
    out.push_back(
        text("at %.0f mm the part is %.0f px wide: bring the sensor nearer, or take a longer lens",
             info.distance_max_mm, width_px));
  }
  if (test.record.precision < kPrecisionWanted) {
    out.push_back(
        text("%.1f %% of what is reported with a score of %.2f or more is right: raise min_score",
             100 * test.record.precision, test.threshold));
  }
  if (!test.confusions.empty() && test.confusions[0].count >= 2) {
    const Confusion& c = test.confusions[0];
    out.push_back(
        text("%d of %d wrong poses are turned by %.0f deg about (%.2f %.2f %.2f): a sensor "
             "with sharper edges, or intensity, tells them apart",
             c.count, test.wrong, c.angle_deg, c.axis.x(), c.axis.y(), c.axis.z()));
  }
  double extent[3];
  for (int k = 0; k < 3; ++k) extent[k] = info.bounds_max_mm[k] - info.bounds_min_mm[k];
  std::sort(extent, extent + 3);
  if (extent[0] < kFlat * extent[2]) {
    out.push_back(
        text("the part is flat (%.1f mm of %.1f mm): lying on its like it shows in outlines "
             "and intensity more than in depth, so light it well",
             extent[0], extent[2]));
  }
  if (test.record.recall < kRecallWanted) {
    out.push_back(
        text("%.0f %% of the mostly visible parts are found: expect more cycles for a bin",
             100 * test.record.recall));
  }
  return out;
}

}  // namespace binpick::app
