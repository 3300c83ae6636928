#include "diagnosis/near_reference.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "pose/ray_pose.hpp"

namespace binpick {
namespace {

// From the place of a candidate to where the part's centre is seen.
constexpr double kNearPxMin = 6;
constexpr double kNearLevelPx = 1.5;  // of the candidate's level
// Beyond the spacing of the tree, for what a template accepts.
constexpr double kSpacingMargin = 1.25;
constexpr double kSpacingSlackRad = 5 * kDegree;

Vec2 pixel_of(const Candidate& c) {
  const double scale = 1 << c.level;
  return {(c.x + c.best_pixel % 2 + 0.5) * scale - 0.5,
          (c.y + c.best_pixel / 2 + 0.5) * scale - 0.5};
}

}  // namespace

double reference_error(const ObjectModel& model, const ReferencePose& reference,
                       const Pose& T_cam_centre, double position_mm, double angle_rad) {
  const Vec3 centre = model.centre_mm();
  const Vec3 origin = T_cam_centre.t_mm - T_cam_centre.R * centre;
  double best = 1e9;
  for (const Pose& known : reference.poses) {
    const double shift = (origin - known.t_mm).cwiseAbs().maxCoeff() / position_mm;
    if (shift >= best) continue;
    const Vec3 turn = rotation_vector(T_cam_centre.R * known.R.transpose());
    best = std::min(best, std::max(shift, turn.cwiseAbs().maxCoeff() / angle_rad));
  }
  return best;
}

double node_radius_rad(const ObjectModel& model, int depth) {
  const TreeDepth& d = model.depth(depth);
  // A cap of the sphere with a viewpoint's share of its area, were all viewpoints there.
  const double all = 10 * std::pow(4.0, depth) + 2;  // of an icosahedron, subdivided `depth` times
  const double view = std::acos(1 - 2 / all);
  const double roll = kPi / d.roll_count;
  return kSpacingMargin * std::hypot(view, roll) + kSpacingSlackRad;
}

NearCandidate::NearCandidate(const ObjectModel& model, const ReferencePose& reference, int depth,
                             const FeaturePyramid& pyramid)
    : model_(model),
      reference_(reference),
      pyramid_(pyramid),
      depth_(depth),
      radius_rad_(node_radius_rad(model, depth)),
      spread_px_(0) {
  const Vec3 centre = model.centre_mm();
  const CameraIntrinsics& camera = pyramid.level(0).camera;
  pixel_ = camera.project(reference.poses.front() * centre);
  for (const Pose& p : reference.poses)
    spread_px_ = std::max(spread_px_, (camera.project(p * centre) - pixel_).norm());
}

bool NearCandidate::operator()(const Candidate& c) const {
  const double limit_px = std::max(kNearPxMin, kNearLevelPx * (1 << c.level));
  const Vec2 at = pixel_of(c);
  if ((at - pixel_).squaredNorm() > (limit_px + spread_px_) * (limit_px + spread_px_)) return false;
  const Mat3 R = candidate_pose(model_, depth_, c, pyramid_).R;
  return std::any_of(reference_.poses.begin(), reference_.poses.end(), [&](const Pose& known) {
    const Vec2 seen = pyramid_.level(0).camera.project(known * model_.centre_mm());
    return (at - seen).norm() <= limit_px && rotation_angle_between(R, known.R) <= radius_rad_;
  });
}

}  // namespace binpick
