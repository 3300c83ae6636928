#include "assess/same_pose.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"

namespace binpick::app {
namespace {

// Poses of one part scatter by far less, and two parts that touch are farther apart.
constexpr double kSameShift = 0.25;  // of the diameter
constexpr double kSameAngle = 20 * kDegree;
// Two transforms nearer than this, in the same units, are one.
constexpr double kOneTransform = 0.2;

SamePose::Axis axis_of(const SymmetryAxis& a) {
  return {vector_of(a.axis), vector_of(a.point_mm)};
}

Pose about(const SamePose::Axis& axis, double angle_rad) {
  const Mat3 R = rotation_from_vector(axis.direction * angle_rad);
  return {R, axis.point_mm - R * axis.point_mm};
}

// The angle about the axis that brings R nearest to `to`.
double best_angle(const Vec3& axis, const Mat3& R, const Mat3& to) {
  const Mat3 Q = R.transpose() * to;
  const Vec3 turn(Q(2, 1) - Q(1, 2), Q(0, 2) - Q(2, 0), Q(1, 0) - Q(0, 1));
  return std::atan2(axis.dot(turn), Q.trace() - axis.dot(Q * axis));
}

}  // namespace

SamePose::SamePose(const PartSymmetry& symmetry, double diameter_mm, NearSymmetry near)
    : diameter_mm_(diameter_mm), transforms_{Pose{}}, ball_(symmetry.exact_axes.size() > 1) {
  const auto counts = [near](SymmetryKind kind) {
    return near == NearSymmetry::kEquivalent ||
           (near == NearSymmetry::kAuto && kind == SymmetryKind::kIndistinguishable);
  };
  for (const SymmetryTurn& turn : symmetry.exact_turns) transforms_.push_back(move_of(turn));
  for (const SymmetryAxis& axis : symmetry.exact_axes) axes_.push_back(axis_of(axis));
  exact_transforms_ = transforms_.size();
  exact_axes_ = axes_.size();
  for (const SymmetryTurn& turn : symmetry.near_turns)
    if (counts(turn.kind)) add_near(move_of(turn));
  for (const SymmetryAxis& axis : symmetry.near_axes)
    if (counts(axis.kind)) axes_.push_back(axis_of(axis));
}

// Together with those that are there they are symmetries too.
void SamePose::add_near(const Pose& transform) {
  const std::size_t count = transforms_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Pose combined = transform * transforms_[i];
    const bool known = std::ranges::any_of(transforms_, [&](const Pose& other) {
      return plain_distance(combined, other) < kOneTransform;
    });
    if (!known) transforms_.push_back(combined);
  }
}

double SamePose::plain_distance(const Pose& a, const Pose& b) const {
  return std::max((a.t_mm - b.t_mm).norm() / (kSameShift * diameter_mm_),
                  rotation_angle_between(a.R, b.R) / kSameAngle);
}

Pose SamePose::nearest_of(const Pose& pose, const Pose& to, std::size_t transforms,
                          std::size_t axes) const {
  if (ball_) {
    const Vec3& middle = axes_.front().point_mm;
    return {to.R, pose * middle - to.R * middle};
  }
  Pose best = pose;
  double best_distance = plain_distance(pose, to);
  const auto offer = [&](const Pose& candidate) {
    const double distance = plain_distance(candidate, to);
    if (distance < best_distance) best = candidate, best_distance = distance;
  };
  for (std::size_t t = 0; t < transforms; ++t) {
    const Pose moved = pose * transforms_[t];
    offer(moved);
    for (std::size_t a = 0; a < axes; ++a)
      offer(moved * about(axes_[a], best_angle(axes_[a].direction, moved.R, to.R)));
  }
  return best;
}

double SamePose::distance(const Pose& a, const Pose& b) const {
  return plain_distance(nearest(a, b), b);
}

bool SamePose::flipped(const Pose& a, const Pose& b) const {
  return distance(a, b) < 1 &&
         plain_distance(nearest_of(a, b, exact_transforms_, exact_axes_), b) >= 1;
}

}  // namespace binpick::app
