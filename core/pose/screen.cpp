#include "pose/screen.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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
constexpr double kSameRotation = 5 * std::numbers::pi / 180;
constexpr double kSamePositionShare = 0.03;  // of the diameter
// Of a part that shows well hundreds of neighbouring templates fit: a few of them are as good a
// start, and leave room for parts that show less.
constexpr double kSamePlaceShare = 0.25;  // of the diameter, between centres
constexpr int kPerPlace = 10;

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
  std::size_t kept = 0;
  for (const Hypothesis& h : ranked) {
    const double limit_mm =
        kSamePositionShare * context.models[h.candidate.model].info().diameter_mm;
    if (!h.alive) {
      count_drop(report, h.drop_reason);
    } else if (kept == out.size()) {
      count_drop(report, DropReason::kLevelLimit);
    } else {
      const double place_mm =
          kSamePlaceShare * context.models[h.candidate.model].info().diameter_mm;
      int here = 0;
      bool repeated = false;
      for (std::size_t k = 0; k < kept && !repeated; ++k) {
        repeated = same_pose(context, out[k], h, limit_mm, kSameRotation);
        here += (out[k].T_cam_centre.t_mm - h.T_cam_centre.t_mm).norm() < place_mm;
      }
      if (repeated || here >= kPerPlace) {
        count_drop(report, repeated ? DropReason::kDuplicate : DropReason::kLevelLimit);
      } else {
        out[kept++] = h;
      }
    }
  }
  return static_cast<int>(kept);
}

}  // namespace binpick
