#include "pose/contour_pose.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "pose/pnp.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

constexpr int kPointsMax = 192;
constexpr int kPointsMin = 16;
// A leaf's pose is off by half its spacing in turn and distance: some pixels at the outline.
constexpr int kPnpRangesPx[] = {8, 5};
// How far PnP may go from the template's pose.
constexpr double kTurnMax = 20 * kDegree;
constexpr double kShiftMax = 0.12;     // of the diameter, across the view
constexpr double kDistanceMax = 0.12;  // of the distance
// An edge's place beside the contour: noise of the image, and what shading and a rounded rim do.
constexpr double kEdgeSigmaPx = 0.5;
constexpr int kRefineRangesPx[] = {4, 3, 3, 3, 2, 2, 2, 2, 2, 2};

template <class Visit>
void visit_edges(const ObjectModel& model, const Scene& scene, const Pose& T, int range_px,
                 Visit&& visit) {
  for (const ContourSample& sample : model.contour(nearest_viewpoint(model, T))) {
    const ContourPlace place = place_contour(sample, scene, T, range_px, 0);
    if (!place.visible) continue;
    const ContourMatch m = match_directed(place, scene, range_px);
    if (m.found) visit(sample, place, m);
  }
}

bool nearby(const Pose& T, const Pose& start, double diameter_mm) {
  // Both seen from the same distance: what is left is the shift across the view.
  const double ratio = T.t_mm.z() / start.t_mm.z();
  return std::abs(ratio - 1) < kDistanceMax && rotation_angle_between(T.R, start.R) < kTurnMax &&
         (T.t_mm / ratio - start.t_mm).norm() < kShiftMax * diameter_mm;
}

}  // namespace

bool pose_from_contour(const ObjectModel& model, const Scene& scene, Pose& T) {
  const Pose start = T;
  for (const int range_px : kPnpRangesPx) {
    Correspondence found[kPointsMax];
    std::size_t count = 0;
    visit_edges(model, scene, T, range_px,
                [&](const ContourSample& sample, const ContourPlace& place, const ContourMatch& m) {
                  if (count == kPointsMax) return;
                  found[count++] = {position_of(sample),
                                    place.pixel + m.offset_px * place.normal_px, place.normal_px,
                                    robust_weight(m.offset_px, 2 * range_px)};
                });
    if (count < kPointsMin) return false;
    Pose solved = T;
    const PnpResult result = solve_pnp({found, count}, scene.intensity.camera, solved);
    if (!result.converged || !nearby(solved, start, model.info().diameter_mm)) return false;
    T = solved;
  }
  return true;
}

int add_directed_residuals(const ObjectModel& model, const Scene& scene, const Pose& T,
                           int range_px, NormalEquations& equations) {
  const CameraIntrinsics& camera = scene.intensity.camera;
  int found = 0;
  visit_edges(model, scene, T, range_px,
              [&](const ContourSample&, const ContourPlace& place, const ContourMatch& m) {
                const Vec3 n = pulled_back(place, camera);
                equations.add(point_gradient(n, place.point_cam, T.t_mm) / kEdgeSigmaPx,
                              -m.offset_px / kEdgeSigmaPx, robust_weight(m.offset_px, range_px));
                ++found;
              });
  return found;
}

void refine_on_contour(const ObjectModel& model, const Scene& scene, Pose& T) {
  const double radius = model.info().diameter_mm / 4;
  for (const int range_px : kRefineRangesPx) {
    NormalEquations equations;
    if (add_directed_residuals(model, scene, T, range_px, equations) < kPointsMin) return;
    // Next to no damping: a distance is held by little, and has to be found all the same.
    const auto step = equations.solve(0.01 * radius * radius, 0.01);
    const Vec3 turn = step.head<3>(), shift = step.tail<3>();
    if (shift.norm() > kShiftMax * T.t_mm.z()) return;
    T = left_increment(T, turn, shift, T.t_mm);
    const bool still = turn.norm() * radius < 0.005 && shift.norm() < 0.01;
    if (still && range_px == kRefinedRangePx) break;
  }
  T.R = orthonormalized(T.R);
}

}  // namespace binpick
