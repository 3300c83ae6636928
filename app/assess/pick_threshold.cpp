#include "assess/pick_threshold.hpp"

#include <algorithm>
#include <map>

namespace binpick::app {
namespace {

constexpr int kSteps = 100;

}  // namespace

double WrongPicks::share() const {
  if (poses.count == 0) return 0;
  return std::max(by_score, static_cast<double>(poses.count - poses.right) / poses.count);
}

WrongPicks wrong_picks(std::span<const ScoredPose> poses, double threshold) {
  WrongPicks out;
  out.threshold = threshold;
  std::map<std::size_t, bool> parts;
  for (const ScoredPose& pose : poses) {
    if (pose.score < threshold) continue;
    out.by_score += 1 - pose.score;
    ++out.poses.count;
    out.poses.right += pose.found_again;
    parts[pose.track] = pose.found_again;
  }
  for (const auto& [track, found_again] : parts) {
    ++out.parts.count;
    out.parts.right += found_again;
  }
  if (out.poses.count > 0) out.by_score /= out.poses.count;
  return out;
}

std::optional<WrongPicks> suggest_threshold(std::span<const ScoredPose> poses, double share_max) {
  for (int i = 1; i < kSteps; ++i) {
    const WrongPicks picks = wrong_picks(poses, static_cast<double>(i) / kSteps);
    if (picks.poses.count > 0 && picks.share() <= share_max) return picks;
  }
  return std::nullopt;
}

int parts_to_promise(double share_max) {
  int count = 1;
  while (1 - RightShare{count, count}.low() > share_max) ++count;
  return count;
}

}  // namespace binpick::app
