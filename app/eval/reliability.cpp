#include "eval/reliability.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "eval/run_summary.hpp"

namespace binpick::app {
namespace {

// Tenths, and finer at the top, where right poses crowd and robots pick.
constexpr std::array kEdges = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 1.0};
constexpr double kDeviations = 1.959964;  // of the normal distribution, for 95 %

// Wilson's interval: middle and half of its width.
struct Interval {
  double middle, half;
};

Interval wilson(const RightShare& seen) {
  if (seen.count == 0) return {0.5, 0.5};
  const double n = seen.count, z2 = kDeviations * kDeviations, p = seen.share();
  return {(p + z2 / (2 * n)) / (1 + z2 / n),
          kDeviations * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n)) / (1 + z2 / n)};
}

void add(RightShare& seen, const JudgedPose& pose) {
  ++seen.count;
  seen.right += pose.right;
}

}  // namespace

double RightShare::low() const {
  const Interval i = wilson(*this);
  return std::max(0.0, i.middle - i.half);
}

double RightShare::high() const {
  const Interval i = wilson(*this);
  return std::min(1.0, i.middle + i.half);
}

Reliability reliability_of(const std::vector<JudgedPose>& poses, double threshold) {
  Reliability r;
  r.threshold = threshold;
  r.count = static_cast<int>(poses.size());
  for (std::size_t i = 0; i + 1 < kEdges.size(); ++i)
    r.bins.push_back({kEdges[i], kEdges[i + 1], 0, {}});
  for (const JudgedPose& pose : poses) {
    const auto above = std::upper_bound(kEdges.begin() + 1, kEdges.end() - 1, pose.probability);
    ReliabilityBin& bin = r.bins[static_cast<std::size_t>(above - kEdges.begin() - 1)];
    bin.probability += pose.probability;
    add(bin.seen, pose);
    if (pose.probability >= threshold) add(r.accepted, pose);
  }
  for (ReliabilityBin& bin : r.bins) {
    if (bin.seen.count == 0) continue;
    bin.probability /= bin.seen.count;
    r.calibration_error += std::abs(bin.probability - bin.seen.share()) * bin.seen.count / r.count;
  }
  return r;
}

std::vector<JudgedPose> judged_poses(const PartScore& part, const std::vector<ResultRow>& rows) {
  std::vector<JudgedPose> poses;
  for (const DetectionMark& mark : part.marks)
    poses.push_back({rows[mark.row_index].score, mark.verdict != Verdict::kWrong});
  return poses;
}

std::vector<Reliability> find_reliability(const ScoreReport& report,
                                          const std::vector<ResultRow>& rows, double threshold) {
  std::vector<Reliability> out;
  std::vector<JudgedPose> all;
  for (const auto* parts : {&report.parts, &report.mixed}) {
    for (const PartScore& part : *parts) {
      const std::vector<JudgedPose> poses = judged_poses(part, rows);
      out.push_back(reliability_of(poses, threshold));
      out.back().name = part_name(part);
      all.insert(all.end(), poses.begin(), poses.end());
    }
  }
  if (all.empty()) return {};
  out.push_back(reliability_of(all, threshold));
  out.back().name = "all";
  return out;
}

}  // namespace binpick::app
