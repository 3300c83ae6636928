#include "pose/score_candidates.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "pose/contour.hpp"
#include "pose/ray_pose.hpp"
#include "pose/tolerances.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

// Of the surface, to find the distance, and then to see how well it agrees.
constexpr int kDistanceSamples = 96, kSupportSamples = 64;
constexpr int kAgreeingMin = 8;
// Depth differences within this belong to one surface.
constexpr double kWindowShare = 0.08;  // of the diameter
constexpr int kBinsPerWindow = 4, kBinsMax = 512;
// A leaf's pose is off by up to half its spacing: about 5 degrees at half a diameter.
constexpr double kLeafErrorShare = 0.04;  // of the diameter
// Support counts fully once this share of the surface is measured and not hidden.
constexpr double kSeenEnough = 0.3;
// Whatever does not conflict agrees; normals fully up to 37 degrees, not at all from 90.
constexpr float kAnyFitMm = 1e6f, kNormalsAgreeCos = 0.8f;
constexpr int kEdgeRangePx = 3;

// How far along the viewing ray the measured surface is from the pose: the middle of the densest
// group among the depth differences of the visible samples, so that occluders in front and
// background behind do not pull. False where too few samples agree.
bool find_distance(const ObjectModel& model, const Scene& scene, const Viewpoint& view,
                   double range_mm, Pose& T) {
  simd::SurfaceLook look;
  const SampleArrays all = model.surface(view);
  const SampleArrays surface = all.first(std::min(all.count, kDistanceSamples));
  scene.kernels.look_at_surface(surface, pose_f(T), scene.depth_map, look);
  const double bin_mm = std::max(kWindowShare * model.info().diameter_mm / kBinsPerWindow,
                                 2 * range_mm / (kBinsMax - 1));
  const int bins = static_cast<int>(2 * range_mm / bin_mm) + 1;
  const auto range = static_cast<float>(range_mm), bins_per_mm = static_cast<float>(1 / bin_mm);
  // What is out of range or not measured goes to a bin of its own, behind the others.
  int bin_of[kDistanceSamples];
  std::uint16_t counts[kBinsMax + 1];
  std::fill_n(counts, bins + 1, std::uint16_t{0});
  for (int i = 0; i < surface.count; ++i) {
    const float offset = look.offset_mm[i];
    const float within = std::min(std::max(offset, -range), range);
    bin_of[i] = within == offset ? static_cast<int>((offset + range) * bins_per_mm) : bins;
  }
  for (int i = 0; i < surface.count; ++i) ++counts[bin_of[i]];
  int best = 0, best_count = 0, window = 0;
  for (int b = 0; b < bins; ++b) {
    window += counts[b];
    if (b >= kBinsPerWindow) window -= counts[b - kBinsPerWindow];
    if (window > best_count) {
      best_count = window;
      best = b;
    }
  }
  if (best_count < kAgreeingMin) return false;
  double sum_mm = 0;
  for (int i = 0; i < surface.count; ++i) {
    if (bin_of[i] <= best && bin_of[i] > best - kBinsPerWindow)
      sum_mm += static_cast<double>(look.offset_mm[i]);
  }
  T.t_mm *= 1 + sum_mm / best_count / T.t_mm.z();
  return true;
}

// The share of what is measured and not hidden that agrees, times the root of the share of all:
// clutter fits small pieces of nearly anything, so that what shows and fits much goes before what
// fits as well and shows little.
double surface_support(const ObjectModel& model, const Scene& scene, const Viewpoint& view,
                       const Pose& T) {
  const Tolerances tolerances(model, scene, T);
  const auto conflict_mm =
      static_cast<float>(kLeafErrorShare * model.info().diameter_mm + tolerances.on_surface_mm);
  const SampleArrays all = model.surface(view);
  const SampleArrays surface = all.first(std::min(all.count, kSupportSamples));
  const simd::SurfaceAgreement found =
      surface_agreement(scene, view, surface, T, {kAnyFitMm, conflict_mm, 0, kNormalsAgreeCos, 0});
  if (surface.count == 0) return 0;
  const auto supported = static_cast<double>(found.supported);
  const double seen =
      std::max<double>(found.agreeing + found.contradicted, kSeenEnough * surface.count);
  return supported / seen * std::sqrt(supported / surface.count);
}

// At how many contour points an edge of its direction lies, beyond chance.
double contour_agreement(const ObjectModel& model, const Scene& scene, const Pose& T) {
  const PyramidLevel& level = scene.depth;  // the level of the features
  ContourMatches m;
  place_contour(model, nearest_viewpoint(model, scene.kernels, T), scene, T, kEdgeRangePx, 0, m);
  const simd::ContourPlaces& places = m.places;
  double sum = 0;
  for (int i = 0; i < m.count; ++i) {
    if (!places.visible[i]) continue;
    const int u = nearest_pixel(Scene::depth_level_px(static_cast<double>(places.u[i]))),
              v = nearest_pixel(Scene::depth_level_px(static_cast<double>(places.v[i])));
    if (u < 0 || v < 0 || u >= level.width || v >= level.height) continue;
    const unsigned bits = level.plain.gradient[v * level.plain.stride + u];
    // By chance one of the three directions near the contour's is among those of any k.
    static constexpr double kChance[9] = {0, 0.375, 0.643, 0.821, 0.929, 0.982, 1, 1, 1};
    const bool meets = (bits & edge_directions_near(places.normal_u[i], places.normal_v[i])) != 0;
    sum += (meets ? 1 : 0) - kChance[std::popcount(bits)];
    sum -= bits == 0 ? 0.2 : 0;
  }
  return m.count > 0 ? sum / m.count : 0;
}

Hypothesis scored(const PoseContext& context, const Candidate& candidate,
                  const FeaturePyramid& pyramid) {
  const ObjectModel& model = context.models[candidate.model];
  const int leaf = model.depth_count() - 1;
  Hypothesis h;
  h.candidate = candidate;
  if (context.deadline.passed()) {
    h.drop(DropReason::kDeadline);
    return h;
  }
  h.T_cam_centre = candidate_pose(model, leaf, candidate, pyramid);
  if (!context.scene.with_depth) {
    h.rank = contour_agreement(model, context.scene, h.T_cam_centre);
    return h;
  }
  const Viewpoint& view = leaf_viewpoints(model)[static_cast<std::size_t>(candidate.viewpoint)];
  const double range_mm =
      0.5 * model.info().diameter_mm + 0.75 * model.distance_interval_mm(leaf, candidate.distance);
  if (find_distance(model, context.scene, view, range_mm, h.T_cam_centre)) {
    h.rank = candidate.score * surface_support(model, context.scene, view, h.T_cam_centre);
  } else {
    h.drop(DropReason::kPoseDiverged);
  }
  return h;
}

}  // namespace

void score_candidates(const PoseContext& context, std::span<const Candidate> leaves,
                      const FeaturePyramid& pyramid, std::span<Hypothesis> out) {
  BINPICK_ASSERT(out.size() == leaves.size());
  constexpr int kPerTask = 16;
  const int count = static_cast<int>(leaves.size());
  context.pool.parallel_for((count + kPerTask - 1) / kPerTask, [&](int task, int) {
    for (int i = task * kPerTask; i < std::min(count, (task + 1) * kPerTask); ++i) {
      const auto at = static_cast<std::size_t>(i);
      out[at] = scored(context, leaves[at], pyramid);
    }
  });
}

}  // namespace binpick
