#include "pose/screen.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "pose/contour_evidence.hpp"
#include "pose/icp.hpp"
#include "pose/ray_pose.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

constexpr int kSamplesMax = 64;
// A leaf's pose is off by up to half its spacing: about 5 degrees at half a diameter.
constexpr double kLeafErrorShare = 0.04;  // of the diameter
// Support counts fully once this share of the surface is measured and not hidden.
constexpr double kSeenEnough = 0.3;
// Candidates nearer to each other than this are one: half a leaf's spacing.
constexpr SameLimits kSameLeaf{0.03, 5 * kDegree};
// To a part that shows well hundreds of neighbouring templates fit. The last part of the room is
// for places that have few candidates so far, of parts that show less.
constexpr double kByRankShare = 0.75;
constexpr int kPerPlace = 8;

// At how much of the surface the measured one lies and faces the same way: fully up to 37 degrees
// apart, not at all from 90. The share of what is measured and not hidden, times the root of the
// share of all: clutter fits small pieces of nearly anything, so that what shows and fits much goes
// before what fits as well and shows little.
double surface_support(const ObjectModel& model, const Scene& scene, const Pose& T) {
  const auto surface = model.surface(nearest_viewpoint(model, T));
  const std::size_t step = surface.size() / kSamplesMax + 1;
  const double tolerance_mm =
      kLeafErrorShare * model.info().diameter_mm + 2 * scene.depth_error_mm(T.t_mm.z());
  int samples = 0, seen = 0;
  double supported = 0;
  for (std::size_t i = 0; i < surface.size(); i += step) {
    ++samples;
    const Vec3 p = T * position_of(surface[i]);
    const auto [u, v, z] = scene.measured_at(p);
    if (!(z > 0)) continue;
    const Vec3 n = T.R * normal_of(surface[i]);
    const double r = n.dot(scene.depth.camera.unproject(u, v, z) - p);
    if (z < p.z() && r > tolerance_mm) continue;  // hidden
    ++seen;
    if (std::abs(r) > tolerance_mm) continue;
    supported += std::clamp(1.25 * normal_agreement(scene, u, v, p, n), 0.0, 1.0);
  }
  const double of_seen = supported / std::max<double>(seen, kSeenEnough * samples);
  return samples > 0 ? of_seen * std::sqrt(supported / samples) : 0;
}

Hypothesis screened(const PoseContext& context, const Candidate& candidate,
                    const FeaturePyramid& pyramid) {
  const ObjectModel& model = context.models[candidate.model];
  const ModelInfo& info = model.info();
  const int leaf = model.depth_count() - 1;
  Hypothesis h;
  h.candidate = candidate;
  if (context.deadline.passed()) {
    h.drop(DropReason::kDeadline);
    return h;
  }
  h.T_cam_centre = candidate_pose(model, leaf, candidate, pyramid);
  if (!context.scene.with_depth) {
    h.rank = contour_promise(model, context.scene, h.T_cam_centre);
    return h;
  }
  const double interval_mm = model.distance_interval_mm(leaf, candidate.distance);
  const double range_mm = 0.5 * info.diameter_mm + 0.75 * interval_mm;
  if (!align_depth(model, context.scene, range_mm, h.T_cam_centre)) {
    h.drop(DropReason::kPoseDiverged);
    return h;
  }
  h.rank = candidate.score * surface_support(model, context.scene, h.T_cam_centre);
  return h;
}

struct Selection {
  int kept = 0, repeated = 0;
};

// The best that do not repeat one another, of a list that is sorted.
Selection select(const PoseContext& context, std::span<const Hypothesis> ranked,
                 std::span<Hypothesis> out) {
  Selection found;
  const int by_rank = static_cast<int>(kByRankShare * static_cast<double>(out.size()));
  for (const Hypothesis& h : ranked) {
    if (!h.alive || found.kept == static_cast<int>(out.size())) break;
    const Neighbours near =
        neighbours_of(context, out.first(static_cast<std::size_t>(found.kept)), h, kSameLeaf);
    found.repeated += near.repeated;
    if (!near.repeated && (found.kept < by_rank || near.at_place < kPerPlace))
      out[static_cast<std::size_t>(found.kept++)] = h;
  }
  return found;
}

}  // namespace

int screen_candidates(const PoseContext& context, std::span<const Candidate> leaves,
                      const FeaturePyramid& pyramid, std::span<Hypothesis> scratch,
                      std::span<Hypothesis> out, DetectionReport& report) {
  BINPICK_ASSERT(scratch.size() >= leaves.size());
  constexpr int kPerTask = 16;
  const int count = static_cast<int>(leaves.size());
  context.pool.parallel_for((count + kPerTask - 1) / kPerTask, [&](int task, int) {
    for (int i = task * kPerTask; i < std::min(count, (task + 1) * kPerTask); ++i) {
      const auto at = static_cast<std::size_t>(i);
      scratch[at] = screened(context, leaves[at], pyramid);
    }
  });
  const std::span<Hypothesis> ranked = scratch.first(leaves.size());
  std::sort(ranked.begin(), ranked.end(), better_hypothesis);
  const Selection selection = select(context, ranked, out);
  int living = 0;
  for (const Hypothesis& h : ranked) {
    if (h.alive) {
      ++living;
    } else {
      count_drop(report, h.drop_reason);
    }
  }
  report.dropped[static_cast<int>(DropReason::kDuplicate)] += selection.repeated;
  report.dropped[static_cast<int>(DropReason::kLevelLimit)] +=
      living - selection.repeated - selection.kept;
  return selection.kept;
}

}  // namespace binpick
