// The balanced pose tree: how it halves, who is whose child, and that it leaves no pose uncovered.
#include "train/pose_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "binpick/geometry/angle.hpp"
#include "train/toy_part.hpp"

namespace binpick::train {
namespace {

// No direction is farther than this from a vertex of the sphere with 642 vertices.
constexpr double kViewpointReach_deg = 5.4;

double angle_deg(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

Vec3 random_direction(std::mt19937_64& engine, double tilt_max_deg) {
  const double z = uniform(engine, std::cos(tilt_max_deg * kDegree), 1);
  const double turn = uniform(engine, 0, 2 * kPi), r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(turn), r * std::sin(turn), z};
}

// A camera that looks at the object from `direction`, with any roll.
Mat3 random_rotation(std::mt19937_64& engine, const Vec3& direction_obj) {
  return rotation_z(uniform(engine, 0, 2 * kPi)) * rotation_between(direction_obj, -Vec3::UnitZ());
}

const TreeViewpoint& nearest_leaf(const PoseTree& tree, const Vec3& direction_obj) {
  return *std::ranges::max_element(tree.leaves().viewpoints, {}, [&](const TreeViewpoint& v) {
    return v.direction_obj.dot(direction_obj);
  });
}

TEST(PoseTree, Has12To642ViewpointsAndDoublesTheRolls) {
  const PoseTree tree = make_pose_tree(toy_options());
  ASSERT_EQ(tree.depths.size(), 4u);
  const std::size_t viewpoints[] = {12, 42, 162, 642};
  const int rolls[] = {8, 16, 32, 64};
  for (std::size_t d = 0; d < 4; ++d) {
    EXPECT_EQ(tree.depths[d].viewpoints.size(), viewpoints[d]);
    EXPECT_EQ(tree.depths[d].roll_count, rolls[d]);
  }
  // 6 degrees, rounded so that they halve evenly.
  EXPECT_DOUBLE_EQ(360.0 / tree.leaves().roll_count, 5.625);
}

TEST(PoseTree, HalvesTheDistancesUpwards) {
  TrainOptions options = toy_options();
  struct Case {
    double min_mm, max_mm, interval_mm;
    int counts[4];
  };
  for (const Case& c : {Case{500, 700, 70, {1, 1, 2, 3}}, Case{500, 1060, 70, {1, 2, 4, 8}},
                        Case{500, 1120, 70, {2, 3, 5, 9}}, Case{600, 600, 70, {1, 1, 1, 1}}}) {
    options.distance_min_mm = c.min_mm;
    options.distance_max_mm = c.max_mm;
    options.distance_interval_mm = c.interval_mm;
    const PoseTree tree = make_pose_tree(options);
    for (std::size_t d = 0; d < 4; ++d) {
      EXPECT_EQ(tree.depths[d].distance_count, c.counts[d]) << c.max_mm << " mm, depth " << d;
    }
    const double step = std::pow(c.max_mm / c.min_mm, 1.0 / tree.leaves().distance_count);
    EXPECT_LE((step - 1) * std::sqrt(c.min_mm * c.max_mm), 1.1 * c.interval_mm);
  }
}

TEST(PoseTree, HasConsecutiveChildrenThatKnowTheirParent) {
  TrainOptions options = toy_options();
  for (const double tilt_max_deg : {180.0, 50.0}) {
    options.tilt_max_deg = tilt_max_deg;
    const PoseTree tree = make_pose_tree(options);
    for (std::size_t d = 0; d < tree.depths.size(); ++d) {
      int next = 0;
      const auto& views = tree.depths[d].viewpoints;
      for (std::size_t i = 0; i < views.size(); ++i) {
        EXPECT_EQ(views[i].parent == -1, d == 0);
        if (d + 1 == tree.depths.size()) {
          EXPECT_EQ(views[i].child_count, 0);
          continue;
        }
        EXPECT_EQ(views[i].child_first, next);
        EXPECT_GE(views[i].child_count, tilt_max_deg == 180 ? 3 : 1);
        EXPECT_LE(views[i].child_count, 4);
        next += views[i].child_count;
        for (int c = views[i].child_first; c < next; ++c) {
          EXPECT_EQ(tree.depths[d + 1].viewpoints.at(c).parent, static_cast<int>(i));
        }
      }
      if (d + 1 < tree.depths.size()) {
        EXPECT_EQ(next, static_cast<int>(tree.depths[d + 1].viewpoints.size()));
      }
    }
  }
}

TEST(PoseTree, NestsTheRollsOfChildrenInTheirParents) {
  const PoseTree tree = make_pose_tree(toy_options());
  for (std::size_t d = 0; d + 1 < tree.depths.size(); ++d) {
    const int rolls = tree.depths[d].roll_count;
    const double half = kPi / rolls;
    for (int r = 0; r < rolls; ++r) {
      const double centre = roll_centre_rad(r, rolls);
      const double first = roll_centre_rad(2 * r, 2 * rolls);
      const double second = roll_centre_rad(2 * r + 1, 2 * rolls);
      EXPECT_NEAR(first, centre - half / 2, 1e-12);
      EXPECT_NEAR(second, centre + half / 2, 1e-12);
    }
  }
}

TEST(PoseTree, LooksFromEachDirection) {
  const PoseTree tree = make_pose_tree(toy_options());
  for (const TreeLayer& layer : tree.depths) {
    for (const TreeViewpoint& v : layer.viewpoints) {
      EXPECT_NEAR(v.direction_obj.norm(), 1, 1e-12);
      EXPECT_LT((v.R_view_obj * v.R_view_obj.transpose() - Mat3::Identity()).norm(), 1e-12);
      EXPECT_NEAR(v.R_view_obj.determinant(), 1, 1e-12);
      // The camera stands at (0, 0, -distance) from the object, in its own axes.
      const Pose T_cam_obj{v.R_view_obj, Vec3(0, 0, 600)};
      const Vec3 camera_obj = T_cam_obj.inverse() * Vec3::Zero();
      EXPECT_LT((camera_obj - 600 * v.direction_obj).norm(), 1e-9);
    }
  }
}

TEST(PoseTree, CarriesFramesFromParentToChildWithoutTwist) {
  const PoseTree tree = make_pose_tree(toy_options());
  for (std::size_t d = 1; d < tree.depths.size(); ++d) {
    for (const TreeViewpoint& child : tree.depths[d].viewpoints) {
      const TreeViewpoint& parent = tree.depths[d - 1].viewpoints.at(child.parent);
      const Vec3 turn = rotation_vector(child.R_view_obj * parent.R_view_obj.transpose());
      EXPECT_NEAR(turn.z(), 0, 1e-9);
      EXPECT_NEAR(turn.norm() / kDegree, angle_deg(child.direction_obj, parent.direction_obj),
                  1e-6);
    }
  }
}

TEST(PoseTree, HasALeafNearEveryPose) {
  const PoseTree tree = make_pose_tree(toy_options());
  const int rolls = tree.leaves().roll_count;
  const double half_roll_deg = 180.0 / rolls;
  std::mt19937_64 engine(7);
  double worst_view_deg = 0, worst_total_deg = 0;
  for (int i = 0; i < 10000; ++i) {
    const Vec3 direction = random_direction(engine, 180);
    const Mat3 R = random_rotation(engine, direction);
    const TreeViewpoint& leaf = nearest_leaf(tree, direction);
    double nearest_deg = 180;
    for (int r = 0; r < rolls; ++r) {
      const Mat3 R_leaf = rotation_z(roll_centre_rad(r, rolls)) * leaf.R_view_obj;
      nearest_deg = std::min(nearest_deg, rotation_angle_between(R, R_leaf) / kDegree);
    }
    worst_view_deg = std::max(worst_view_deg, angle_deg(direction, leaf.direction_obj));
    worst_total_deg = std::max(worst_total_deg, nearest_deg);
  }
  std::printf("farthest from a leaf: viewpoint %.2f deg, rotation %.2f deg\n", worst_view_deg,
              worst_total_deg);
  EXPECT_LT(worst_view_deg, kViewpointReach_deg);
  EXPECT_LT(worst_total_deg, std::hypot(kViewpointReach_deg, half_roll_deg));
}

TEST(PoseTree, LeavesOutWhatLiesBeyondTheTiltLimitAndNoMore) {
  TrainOptions options = toy_options();
  std::mt19937_64 engine(8);
  std::size_t fewer = 0;
  for (const double limit_deg : {1.0, 17.0, 45.0, 90.0, 133.0, 176.0}) {
    options.tilt_max_deg = limit_deg;
    const PoseTree tree = make_pose_tree(options);
    EXPECT_GE(tree.leaves().viewpoints.size(), fewer);
    fewer = tree.leaves().viewpoints.size();
    for (const TreeViewpoint& v : tree.leaves().viewpoints) {
      EXPECT_LT(angle_deg(v.direction_obj, Vec3::UnitZ()), limit_deg + kViewpointReach_deg);
    }
    double worst_deg = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 direction = random_direction(engine, limit_deg);
      const Vec3& leaf = nearest_leaf(tree, direction).direction_obj;
      worst_deg = std::max(worst_deg, angle_deg(direction, leaf));
    }
    EXPECT_LT(worst_deg, kViewpointReach_deg) << "limit " << limit_deg;
  }
  EXPECT_LT(fewer, 643u);
}

}  // namespace
}  // namespace binpick::train
