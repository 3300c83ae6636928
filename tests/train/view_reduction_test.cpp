// The viewpoints that a symmetric part keeps: few, and enough for every pose.
#include "train/view_reduction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "train/pose_tree.hpp"
#include "train/shell_points.hpp"
#include "train/toy_part.hpp"

namespace binpick::train {
namespace {

// From any direction to the nearest of 642 viewpoints.
constexpr double kReach_deg = 5.5;

SymmetryTurn turn(const Vec3& axis, double angle_deg) {
  SymmetryTurn t{};
  for (int i = 0; i < 3; ++i) t.axis[i] = static_cast<float>(axis[i]);
  t.angle_rad = static_cast<float>(angle_deg * kDegree);
  return t;
}

FoundSymmetry folds(const Vec3& axis, int fold) {
  FoundSymmetry s;
  for (int k = 1; k < fold; ++k) s.turns.push_back(turn(axis, 360.0 * k / fold));
  return s;
}

FoundSymmetry continuous(const Vec3& axis) {
  FoundSymmetry s;
  SymmetryAxis a{};
  for (int i = 0; i < 3; ++i) a.axis[i] = static_cast<float>(axis[i]);
  s.axes.push_back(a);
  return s;
}

// How far, at most, a direction within the tilt limit is from a kept viewpoint, for the best of the
// directions that `equivalent` says are its like.
template <class Equivalent>
double farthest_deg(const PoseTree& tree, double tilt_max_deg, Equivalent&& equivalent) {
  double worst = 0;
  for (const Vec3& direction : even_directions(3000)) {
    if (direction.z() < std::cos(tilt_max_deg * kDegree)) continue;
    double best = -1;
    for (const Vec3& d : equivalent(direction)) {
      for (const TreeViewpoint& v : tree.leaves().viewpoints)
        best = std::max(best, v.direction_obj.dot(d));
    }
    worst = std::max(worst, std::acos(std::min(1.0, best)) / kDegree);
  }
  return worst;
}

std::vector<Vec3> turned_by(const FoundSymmetry& symmetry, const Vec3& direction) {
  std::vector<Vec3> out = {direction};
  for (const SymmetryTurn& t : symmetry.turns) out.push_back(move_of(t).R * direction);
  return out;
}

void expect_sound(const PoseTree& tree) {
  for (std::size_t d = 0; d + 1 < tree.depths.size(); ++d) {
    int next = 0;
    for (std::size_t i = 0; i < tree.depths[d].viewpoints.size(); ++i) {
      const TreeViewpoint& v = tree.depths[d].viewpoints[i];
      EXPECT_EQ(next, v.child_first);
      EXPECT_GE(v.child_count, 1);
      EXPECT_LE(v.child_count, 4);
      for (int c = v.child_first; c < v.child_first + v.child_count; ++c)
        EXPECT_EQ(static_cast<int>(i), tree.depths[d + 1].viewpoints[c].parent);
      next += v.child_count;
    }
    EXPECT_EQ(next, static_cast<int>(tree.depths[d + 1].viewpoints.size()));
  }
}

TEST(ViewReduction, WithoutAnExactSymmetryAllAreNeeded) {
  FoundSymmetry near = folds(Vec3::UnitZ(), 2);
  near.turns[0].kind = SymmetryKind::kNear;
  EXPECT_EQ(642u, make_pose_tree(toy_options()).leaves().viewpoints.size());
  EXPECT_EQ(642u, make_pose_tree(toy_options(), near).leaves().viewpoints.size());
}

TEST(ViewReduction, OfFoldsKeepsTheirShareAndARim) {
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0.6, 0, 0.8), Vec3(1, 0, 0)}) {
    for (const int fold : {2, 6}) {
      const FoundSymmetry symmetry = folds(axis, fold);
      const PoseTree tree = make_pose_tree(toy_options(), symmetry);
      EXPECT_LT(tree.leaves().viewpoints.size(), 642u / static_cast<unsigned>(fold) + 60);
      EXPECT_LT(farthest_deg(tree, 180, [&](const Vec3& d) { return turned_by(symmetry, d); }),
                kReach_deg);
      expect_sound(tree);
    }
  }
}

TEST(ViewReduction, OfAnAxisKeepsOneMeridian) {
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0, -0.6, 0.8)}) {
    const PoseTree tree = make_pose_tree(toy_options(), continuous(axis));
    EXPECT_LT(tree.leaves().viewpoints.size(), 60u);
    const auto all_around = [&](const Vec3& d) {
      std::vector<Vec3> out;
      for (int k = 0; k < 360; ++k) out.push_back(rotation_from_vector(axis * k * kDegree) * d);
      return out;
    };
    EXPECT_LT(farthest_deg(tree, 180, all_around), kReach_deg);
    expect_sound(tree);
  }
}

TEST(ViewReduction, OfABallKeepsOneViewpoint) {
  FoundSymmetry ball = continuous(Vec3::UnitX());
  ball.axes.push_back(continuous(Vec3::UnitY()).axes[0]);
  EXPECT_EQ(1u, make_pose_tree(toy_options(), ball).leaves().viewpoints.size());
}

TEST(ViewReduction, KeepsToTheTiltLimit) {
  TrainOptions options = toy_options();
  options.tilt_max_deg = 60;
  const FoundSymmetry flips = folds(Vec3(1, 0, 0), 2);  // what is within has its like without
  EXPECT_LT(farthest_deg(make_pose_tree(options, flips), 60,
                         [](const Vec3& d) { return std::vector<Vec3>{d}; }),
            kReach_deg);
  const FoundSymmetry thirds = folds(Vec3(0, 0, 1), 3);
  const PoseTree tree = make_pose_tree(options, thirds);
  EXPECT_LT(2 * tree.leaves().viewpoints.size(),
            make_pose_tree(options).leaves().viewpoints.size());
  EXPECT_LT(farthest_deg(tree, 60, [&](const Vec3& d) { return turned_by(thirds, d); }),
            kReach_deg);
}

}  // namespace
}  // namespace binpick::train
