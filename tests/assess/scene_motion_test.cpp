// How a scene moved, from poses that scatter, are missing, wrong, or turned by a symmetry.
#include "assess/scene_motion.hpp"

#include <gtest/gtest.h>

#include "scattered_poses.hpp"

namespace binpick::app {
namespace {

const Pose kMotion{rotation_from_vector({0.05, -0.08, 0.7}), {40, -25, 12}};

std::vector<Pose> scene(int count, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-120, 120);
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back({rotation_from_vector(2.5 * random_unit(random)),
                     {place(random), place(random), 500 + 0.2 * place(random)}});
  }
  return poses;
}

std::vector<Observation> frame_of(const std::vector<Pose>& poses, const Pose& motion,
                                  PoseNoise& noise, double score = 0.8) {
  std::vector<Observation> out;
  for (const Pose& pose : poses) out.push_back(observation(0, noise(motion * pose), score));
  return out;
}

void append(std::vector<Observation>& to, const std::vector<Observation>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

void expect_motion(const SceneMotion& found) {
  EXPECT_TRUE(found.determined());
  const Vec3 middle(0, 0, 500);
  EXPECT_LT((found.motion * middle - kMotion * middle).norm(), 0.3);
  EXPECT_LT(rotation_angle_between(found.motion.R, kMotion.R), 0.3 * kDegree);
}

TEST(SceneMotion, IsFoundAmongPosesThatAreWrongOrMissing) {
  PoseNoise noise(Vec3(0.2, 0.2, 0.2), Vec3(0.3, 0.3, 0.3));
  const std::vector<Pose> poses = scene(9);
  std::vector<Observation> from = frame_of(poses, Pose{}, noise);
  std::vector<Observation> to = frame_of({poses.begin() + 2, poses.end()}, kMotion, noise);
  append(from, frame_of(scene(5, 11), Pose{}, noise));
  append(to, frame_of(scene(5, 12), Pose{}, noise));
  const SamePose part = MadeUpPart{}.same();
  const SceneMotion found = find_motion(from, to, {&part, 1});
  expect_motion(found);
  EXPECT_GE(found.agreeing, 7);
  EXPECT_LE(found.agreeing, 8);
  EXPECT_EQ(found.compared, 12);
  EXPECT_NEAR(found.angle_rad, rotation_angle_between(kMotion.R, Mat3::Identity()), 0.01);
}

TEST(SceneMotion, OfPartsWithSymmetriesAndAxes) {
  PoseNoise noise(Vec3(0.2, 0.2, 0.2), Vec3(0.3, 0.3, 0.3));
  MadeUpPart hexagon, pin;
  for (int i = 1; i < 6; ++i) hexagon.exact_turns.push_back(turn_row(Vec3::UnitZ(), 60.0 * i));
  pin.exact_axes.push_back(axis_row(Vec3::UnitX()));
  pin.exact_turns.push_back(turn_row(Vec3::UnitZ(), 180));
  for (const bool rolls : {false, true}) {
    const SamePose part = rolls ? pin.same() : hexagon.same();
    const std::vector<Pose> poses = scene(8);
    const std::vector<Observation> from = frame_of(poses, Pose{}, noise);
    std::vector<Observation> to = frame_of(poses, kMotion, noise);
    for (std::size_t i = 0; i < to.size(); ++i) {
      const auto k = static_cast<double>(i);
      to[i].T_cam_centre = rolls ? turned(to[i].T_cam_centre, Vec3::UnitX(), 71 * k)
                                 : turned(to[i].T_cam_centre, Vec3::UnitZ(), 60 * k);
    }
    const SceneMotion found = find_motion(from, to, {&part, 1});
    expect_motion(found);
    EXPECT_EQ(found.agreeing, 8);
  }
}

TEST(SceneMotion, OneWildPoseDoesNotPullIt) {
  PoseNoise noise(Vec3(0.1, 0.1, 0.1), Vec3(0.2, 0.2, 0.2));
  const std::vector<Pose> poses = scene(8);
  const std::vector<Observation> from = frame_of(poses, Pose{}, noise);
  std::vector<Observation> to = frame_of(poses, kMotion, noise);
  to[3].T_cam_centre.t_mm += Vec3(7, 0, 0);  // still said to be the same
  const SamePose part = MadeUpPart{}.same();
  expect_motion(find_motion(from, to, {&part, 1}));
}

TEST(SceneMotion, IsNotDeterminedByFewOrUnrelatedPosesNorByARegularPattern) {
  PoseNoise noise(Vec3(0.1, 0.1, 0.1), Vec3(0.2, 0.2, 0.2));
  const SamePose part = MadeUpPart{}.same();
  const auto determined = [&](const std::vector<Observation>& from,
                              const std::vector<Observation>& to) {
    return find_motion(from, to, {&part, 1}).determined();
  };
  const std::vector<Pose> two = scene(2);
  EXPECT_FALSE(determined(frame_of(two, Pose{}, noise), frame_of(two, kMotion, noise)));
  EXPECT_FALSE(
      determined(frame_of(scene(8, 1), Pose{}, noise), frame_of(scene(8, 2), Pose{}, noise)));
  EXPECT_FALSE(determined({}, frame_of(two, kMotion, noise)));
  // Of a full bin only three agree.
  std::vector<Observation> from = frame_of(scene(14, 1), Pose{}, noise);
  std::vector<Observation> to = frame_of(scene(14, 2), kMotion, noise);
  append(from, frame_of(scene(3, 3), Pose{}, noise));
  append(to, frame_of(scene(3, 3), kMotion, noise));
  EXPECT_FALSE(determined(from, to));
  // Parts in a tray: shifted by one place nearly all agree as well.
  std::vector<Pose> tray;
  for (int x = 0; x < 6; ++x) tray.push_back(pose_at(45.0 * x, 0));
  EXPECT_FALSE(determined(frame_of(tray, Pose{}, noise), frame_of(tray, kMotion, noise)));
}

TEST(SceneMotion, OfABallIsNone) {
  MadeUpPart ball;
  ball.exact_axes = {axis_row(Vec3::UnitX()), axis_row(Vec3::UnitY()), axis_row(Vec3::UnitZ())};
  PoseNoise noise(Vec3(0.1, 0.1, 0.1), Vec3(9, 9, 9));
  const SamePose part = ball.same();
  const std::vector<Pose> poses = scene(8);
  EXPECT_FALSE(
      find_motion(frame_of(poses, Pose{}, noise), frame_of(poses, kMotion, noise), {&part, 1})
          .determined());
}

}  // namespace
}  // namespace binpick::app
