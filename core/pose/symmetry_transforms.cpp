#include "pose/symmetry_transforms.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

// About a near axis: refinement finds the rest from half a step off.
constexpr int kAnglesPerAxis = 32;
// Two transforms nearer than this are one.
constexpr double kSameShare = 0.02;  // of the diameter
constexpr double kSameAngle = 4 * kDegree;

std::size_t near_max(const ObjectModel& model) {
  const PartSymmetry& s = model.symmetry();
  return s.near_turns.size() + s.near_axes.size() * (kAnglesPerAxis - 1);
}

bool within(const Pose& a, const Pose& b, double position_mm, double rotation_rad) {
  return (a.t_mm - b.t_mm).squaredNorm() < position_mm * position_mm &&
         rotation_angle_between(a.R, b.R) < rotation_rad;
}

// Returns how many they are.
template <class Row, class Of, class Out>
std::size_t indistinguishable_first(std::span<const Row> rows, Of&& of, std::span<Out> out) {
  std::size_t count = 0;
  const auto add_if = [&](bool wanted) {
    for (const Row& row : rows)
      if ((row.kind == SymmetryKind::kIndistinguishable) == wanted) out[count++] = of(row);
  };
  add_if(true);
  const std::size_t first = count;
  add_if(false);
  return first;
}

}  // namespace

void SymmetryTransforms::plan(const ObjectModel& model, ArenaPlan& plan) {
  const PartSymmetry& symmetry = model.symmetry();
  plan.take<Pose>(symmetry.exact_turns.size());
  plan.take<Pose>(near_max(model));
  plan.take<Pose>(symmetry.near_turns.size());
  plan.take<Axis>(symmetry.near_axes.size());
}

SymmetryTransforms::SymmetryTransforms(const ObjectModel& model, Arena& arena)
    : exact_(arena.take<Pose>(model.symmetry().exact_turns.size())),
      near_(arena.take<Pose>(near_max(model))),
      all_near_{arena.take<Pose>(model.symmetry().near_turns.size()),
                arena.take<Axis>(model.symmetry().near_axes.size())} {
  const PartSymmetry& symmetry = model.symmetry();
  for (std::size_t i = 0; i < exact_.size(); ++i) {
    exact_[i] = move_of(symmetry.exact_turns[i]);
    reach_mm_ = std::max(reach_mm_, exact_[i].t_mm.norm());
  }
  axis_count_ = static_cast<int>(std::min<std::size_t>(symmetry.exact_axes.size(), 2));
  if (axis_count_ > 0) {
    const SymmetryAxis& a = symmetry.exact_axes.front();
    axis_ = {vector_of(a.axis), vector_of(a.point_mm)};
    reach_mm_ += 2 * axis_.point_mm.norm();
  }
  indistinguishable_rotations_ =
      indistinguishable_first(symmetry.near_turns, move_of, all_near_.rotations);
  indistinguishable_axes_ = indistinguishable_first(
      symmetry.near_axes,
      [](const SymmetryAxis& a) {
        return Axis{vector_of(a.axis), vector_of(a.point_mm)};
      },
      all_near_.axes);
  std::size_t count = 0;
  const auto add = [&](const Pose& move) {
    const double limit_mm = kSameShare * model.info().diameter_mm;
    const auto known = [&](const Pose& other) { return same(other, move, limit_mm, kSameAngle); };
    if (known(Pose{}) ||
        std::any_of(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(count), known))
      return;
    near_[count++] = move;
  };
  for (const SymmetryTurn& t : symmetry.near_turns) add(move_of(t));
  rotation_count_ = count;
  for (const SymmetryAxis& a : symmetry.near_axes) {
    for (int i = 1; i < kAnglesPerAxis; ++i) add(move_about(a, i * 2 * kPi / kAnglesPerAxis));
  }
  near_ = near_.first(count);
}

bool SymmetryTransforms::same(const Pose& a, const Pose& b, double position_mm,
                              double rotation_rad) const {
  const double reach = position_mm + reach_mm_;
  if ((a.t_mm - b.t_mm).squaredNorm() >= reach * reach) return false;
  if (axis_count_ > 1) return (a.t_mm - b.t_mm).squaredNorm() < position_mm * position_mm;
  if (axis_count_ == 1) {
    if (axis_.brings_together(a, b, position_mm, rotation_rad)) return true;
    return std::any_of(exact_.begin(), exact_.end(), [&](const Pose& move) {
      return axis_.brings_together(a * move, b, position_mm, rotation_rad);
    });
  }
  if (within(a, b, position_mm, rotation_rad)) return true;
  return std::any_of(exact_.begin(), exact_.end(), [&](const Pose& move) {
    return within(a * move, b, position_mm, rotation_rad);
  });
}

SymmetryTransforms::NearMoves SymmetryTransforms::counting_as(NearSymmetry near) const {
  if (near == NearSymmetry::kEquivalent) return all_near_;
  if (near == NearSymmetry::kDistinct) return {};
  return {all_near_.rotations.first(indistinguishable_rotations_),
          all_near_.axes.first(indistinguishable_axes_)};
}

bool SymmetryTransforms::has_any(NearSymmetry near) const {
  const NearMoves moves = counting_as(near);
  return axis_count_ > 0 || !exact_.empty() || !moves.rotations.empty() || !moves.axes.empty();
}

bool SymmetryTransforms::looks_same(const Pose& a, const Pose& b, double position_mm,
                                    double rotation_rad, NearSymmetry near) const {
  const NearMoves moves = counting_as(near);
  const auto by_any_axis = [&](const Pose& from) {
    return std::ranges::any_of(moves.axes, [&](const Axis& axis) {
      return axis.brings_together(from, b, position_mm, rotation_rad);
    });
  };
  const auto from = [&](const Pose& pose) {
    return same(pose, b, position_mm, rotation_rad) || by_any_axis(pose) ||
           std::ranges::any_of(exact_, [&](const Pose& move) { return by_any_axis(pose * move); });
  };
  return from(a) ||
         std::ranges::any_of(moves.rotations, [&](const Pose& move) { return from(a * move); });
}

Pose SymmetryTransforms::canonical(const ObjectModel& model, const simd::PoseKernels& kernels,
                                   const Pose& T) const {
  if (axis_count_ == 0 && exact_.empty()) return T;
  if (axis_count_ > 1) {
    const Vec3 wanted = viewing_direction(nearest_viewpoint(model, kernels, T));
    return {T.R * rotation_between(wanted, seen_along(T)), T.t_mm};
  }
  Pose best = T;
  double best_nearness = -2;
  const auto offer = [&](const Pose& same) {
    double nearness = 0;
    Pose pose = same;
    if (axis_count_ == 1) {
      pose = about_axis(model, same, nearness);
    } else {
      const Vec3 seen = seen_along(same);
      nearness = seen.dot(viewing_direction(nearest_viewpoint(model, kernels, seen)));
    }
    if (nearness <= best_nearness) return;
    best_nearness = nearness;
    best = pose;
  };
  offer(T);
  for (const Pose& move : exact_) offer(T * move);
  return best;
}

// Turned about the axis until it is seen from the side of the viewpoint that looks at the axis at
// the angle nearest to the pose's own.
Pose SymmetryTransforms::about_axis(const ObjectModel& model, const Pose& T,
                                    double& nearness) const {
  const Vec3 seen = seen_along(T);
  const double along = std::clamp(axis_.direction.dot(seen), -1.0, 1.0);
  const double across = std::sqrt(1 - along * along);
  Vec3 best = Vec3::Zero();
  nearness = -2;
  for (const Viewpoint& v : model.depth(model.depth_count() - 1).viewpoints) {
    const Vec3 d = viewing_direction(v);
    const double d_along = std::clamp(axis_.direction.dot(d), -1.0, 1.0);
    const double cosine = along * d_along + across * std::sqrt(1 - d_along * d_along);
    if (cosine <= nearness) continue;
    nearness = cosine;
    best = d;
  }
  const Vec3& axis = axis_.direction;
  const Vec3 from = best - axis.dot(best) * axis, to = seen - along * axis;
  if (from.norm() < 1e-6 || to.norm() < 1e-6) return T;
  const double angle = std::atan2(axis.dot(from.cross(to)), from.dot(to));
  const Mat3 R = rotation_from_vector(axis * angle);
  return T * Pose{R, axis_.point_mm - R * axis_.point_mm};
}

bool SymmetryTransforms::Axis::brings_together(const Pose& a, const Pose& b, double position_mm,
                                               double rotation_rad) const {
  // Without the turn that brings them nearest, what is left is how the axes stand to each other,
  // and where a point of them is.
  if ((a * point_mm - b * point_mm).squaredNorm() >= position_mm * position_mm) return false;
  return (a.R * direction).dot(b.R * direction) > std::cos(rotation_rad);
}

}  // namespace binpick
