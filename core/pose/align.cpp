#include "pose/align.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "pose/contour.hpp"
#include "pose/tolerances.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

using enum Residuals;

// With depth the template's distance is corrected before, and the contour joins at the end: it
// does what PnP does for the paper. Without depth PnP finds all six numbers.
//           residuals, iterations, samples, from template, range px, prior
constexpr AlignStep kCoarse[] = {{kDepth, 12, 64, 160, true, 0, 0, 0.02}};  // ICP
constexpr AlignStep kFine[] = {
    {kDepthAndContour, 8, kSurfaceSamplesMax, kSurfaceSamplesMax, false, 6, 2, 3e-4}};
constexpr AlignStep kCoarseOnContour[] = {{kContour, 12, 0, 0, true, 8, 4, 1e-4}};  // PnP
constexpr AlignStep kFineOnContour[] = {{kContour, 10, 0, 0, false, 4, 2, 1e-4}};

// Of an edge's place: noise of the image, and what shading and a rounded rim do to it.
constexpr double kEdgeSigmaPx = 1, kDirectedEdgeSigmaPx = 0.5;
constexpr int kResidualsMin = 10, kEdgesMin = 16;
// Steps below this, at the part's surface, are the end.
constexpr double kStillMm = 0.002;
// How far an alignment on contours alone may go from where it began.
constexpr double kRotationMax = 20 * kDegree;
constexpr double kShiftMax = 0.12;     // of the diameter, across the view
constexpr double kDistanceMax = 0.12;  // of the distance

// Farther away a depth is another surface's: at the start by as much as a template's pose is off,
// at the end by what sensor and model leave.
struct Gate {
  double start_mm, end_mm;

  Gate(const ObjectModel& model, const Tolerances& tolerances, double z_mm)
      : start_mm(std::max(0.08 * model.info().diameter_mm, 0.004 * z_mm)),
        end_mm(std::max({0.02 * model.info().diameter_mm, 0.002 * z_mm, 3 * tolerances.noise_mm})) {
  }
};

void add_depth(const ObjectModel& model, const Viewpoint& view, const Scene& scene, const Pose& T,
               int samples_max, double gate_mm, double sigma_mm, NormalEquations& equations) {
  const SampleArrays surface = model.surface(view);
  simd::EquationSums sums{};
  scene.kernels.surface_equations(surface.first(std::min(surface.count, samples_max)), pose_f(T),
                                  scene.depth_map, static_cast<float>(gate_mm), sums);
  equations.add(sums, sigma_mm);
}

void add_contour(const ObjectModel& model, const Viewpoint& view, const Scene& scene, const Pose& T,
                 int range_px, double hidden_mm, bool directed, NormalEquations& equations) {
  ContourMatches matches;
  place_contour(model, view, scene, T, range_px, hidden_mm, matches);
  match_edges(scene, range_px, matches);
  if (directed) keep_directed_edges(scene, matches);
  const simd::PoseF pose = pose_f(T);
  simd::EquationSums sums{};
  scene.kernels.contour_equations(matches.places, matches.edges, matches.count, pose.t,
                                  scene.gray_map.camera, static_cast<float>(range_px), sums);
  equations.add(sums, directed ? kDirectedEdgeSigmaPx : kEdgeSigmaPx);
}

NormalEquations equations_at(const ObjectModel& model, const Viewpoint& view, const Scene& scene,
                             const Tolerances& tolerances, const AlignStep& step, int samples,
                             double gate_mm, int range_px, const Pose& T) {
  NormalEquations equations;
  const bool directed = step.residuals == kContour;
  if (!directed) {
    add_depth(model, view, scene, T, samples, gate_mm, tolerances.noise_mm, equations);
  }
  if (range_px > 0 && scene.with_intensity) {
    add_contour(model, view, scene, T, range_px, directed ? 0 : tolerances.conflict_mm, directed,
                equations);
  }
  return equations;
}

// The viewpoint of a pose that moves in small steps: looked up again when the part is seen from
// elsewhere by a good part of the viewpoints' spacing.
class FollowedViewpoint {
 public:
  FollowedViewpoint(const ObjectModel& model, const Scene& scene) : model_(model), scene_(scene) {}
  const Viewpoint& at(const Pose& T) {
    constexpr double kSameCos = 0.9998;  // 1.1 degrees
    const Vec3 seen = seen_along(T);
    if (viewpoint_ == nullptr || seen.dot(seen_) < kSameCos) {
      viewpoint_ = &nearest_viewpoint(model_, scene_.kernels, seen);
      seen_ = seen;
    }
    return *viewpoint_;
  }

 private:
  const ObjectModel& model_;
  const Scene& scene_;
  const Viewpoint* viewpoint_ = nullptr;
  Vec3 seen_ = Vec3::Zero();
};

bool nearby(const Pose& T, const Pose& start, double diameter_mm) {
  // Both seen from the same distance: what is left is the shift across the view.
  const double ratio = T.t_mm.z() / start.t_mm.z();
  return std::abs(ratio - 1) < kDistanceMax &&
         rotation_angle_between(T.R, start.R) < kRotationMax &&
         (T.t_mm / ratio - start.t_mm).norm() < kShiftMax * diameter_mm;
}

// Gauss-Newton, each time with the nearest points anew. False where too little holds the pose.
bool run(const ObjectModel& model, const Scene& scene, const AlignStep& step, Pose& T) {
  const double radius_mm = model.info().diameter_mm / 4;
  const Tolerances tolerances(model, scene, T);
  const Gate gate(model, tolerances, T.t_mm.z());
  FollowedViewpoint viewpoint(model, scene);
  const int least = step.residuals == kContour ? kEdgesMin : kResidualsMin;
  for (int i = 0; i < step.iterations_max; ++i) {
    const double progress = static_cast<double>(i) / (step.iterations_max - 1);
    const double gate_mm = step.from_template
                               ? gate.start_mm * std::pow(gate.end_mm / gate.start_mm, progress)
                               : gate.end_mm;
    const auto between = [&](int start, int end) {
      return start + static_cast<int>((end - start) * progress);
    };
    const int range_px = between(step.range_start_px, step.range_end_px);
    const NormalEquations equations =
        equations_at(model, viewpoint.at(T), scene, tolerances, step,
                     between(step.samples_start, step.samples_end), gate_mm, range_px, T);
    if (equations.count < least) return !step.from_template;
    const double prior = step.prior * equations.information;
    const Eigen::Matrix<double, 6, 1> move = equations.solve(prior * radius_mm * radius_mm, prior);
    const Vec3 rotation = move.head<3>(), shift = move.tail<3>();
    T = left_increment(T, rotation, shift, T.t_mm);
    if (!T.t_mm.allFinite() || !T.R.allFinite() || T.t_mm.z() <= 1) return false;
    const bool still = rotation.norm() * radius_mm < kStillMm && shift.norm() < kStillMm;
    if (still && range_px <= step.range_end_px + 1 && gate_mm <= 1.05 * gate.end_mm) break;
  }
  T.R = orthonormalized(T.R);
  return true;
}

}  // namespace

std::span<const AlignStep> coarse_alignment(const Scene& scene) {
  if (scene.with_depth) return kCoarse;
  return kCoarseOnContour;
}

std::span<const AlignStep> fine_alignment(const Scene& scene) {
  if (scene.with_depth) return kFine;
  return kFineOnContour;
}

bool align(const ObjectModel& model, const Scene& scene, std::span<const AlignStep> schedule,
           Pose& T) {
  const Pose start = T;
  for (const AlignStep& step : schedule) {
    if (!run(model, scene, step, T)) return false;
  }
  return scene.with_depth || nearby(T, start, model.info().diameter_mm);
}

NormalEquations final_equations(const ObjectModel& model, const Scene& scene, const Pose& T) {
  const AlignStep& last = fine_alignment(scene).back();
  const Tolerances tolerances(model, scene, T);
  return equations_at(model, nearest_viewpoint(model, scene.kernels, T), scene, tolerances, last,
                      last.samples_end, Gate(model, tolerances, T.t_mm.z()).end_mm,
                      last.range_end_px, T);
}

}  // namespace binpick
