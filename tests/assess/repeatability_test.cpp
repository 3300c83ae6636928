// Standard deviations of poses and what they are compared with.
#include "assess/repeatability.hpp"

#include <gtest/gtest.h>

#include "scattered_poses.hpp"

namespace binpick::app {
namespace {

constexpr int kFrames = 2000;  // deviations are good to 2 %

struct Measured {
  Repeatability repeatability;
  Pose mean;
};

// `roll_deg`: about the part's x axis, from frame to frame.
Measured measure(PoseNoise noise, const SamePose& part, const Mat6& claimed, double roll_deg = 0) {
  std::vector<Observation> poses;
  for (int frame = 0; frame < kFrames; ++frame) {
    const Pose pose = turned(noise(pose_at(20, -10)), Vec3::UnitX(), roll_deg * frame);
    poses.push_back(observation(frame, pose));
    poses.back().covariance = claimed;
  }
  const std::vector<Track> tracks = find_tracks(poses, {&part, 1});
  EXPECT_EQ(tracks.size(), 1u);
  return {repeatability_of(tracks.front(), poses, part), tracks.front().mean};
}

Mat6 covariance_of(const Vec3& sigma_mm, const Vec3& sigma_deg) {
  Vec6 variances;
  variances << (sigma_deg * kDegree).cwiseAbs2(), sigma_mm.cwiseAbs2();
  return variances.asDiagonal();
}

TEST(Repeatability, GivesBackTheNoiseOfEachDirection) {
  const Vec3 shift(0.1, 0.2, 0.4), turn(0.3, 0.6, 1.2);
  const Measured m =
      measure(PoseNoise(shift, turn), MadeUpPart{}.same(), covariance_of(2 * shift, 0.5 * turn));
  const Repeatability& r = m.repeatability;
  EXPECT_EQ(r.count, kFrames);
  for (int i = 0; i < 3; ++i) {
    const auto s = static_cast<std::size_t>(i), t = static_cast<std::size_t>(3 + i);
    EXPECT_NEAR(r.sigma[s], shift[i], 0.06 * shift[i]) << kDirectionNames[s];
    EXPECT_NEAR(r.sigma[t], turn[i], 0.06 * turn[i]) << kDirectionNames[t];
    EXPECT_NEAR(r.claim(i), 2, 0.12);
    EXPECT_NEAR(r.claim(3 + i), 0.5, 0.03);
    EXPECT_FALSE(r.unobservable[t]);
  }
  EXPECT_LT((m.mean.t_mm - pose_at(20, -10).t_mm).norm(), 0.05);
  EXPECT_LT(rotation_angle_between(m.mean.R, pose_at(20, -10).R), 0.1 * kDegree);
}

// Of a pin that rolls: what its axis leaves open is neither measured nor claimed.
TEST(Repeatability, LeavesOutRotationsAboutAnAxisOfThePart) {
  MadeUpPart pin;
  pin.exact_axes.push_back(axis_row(Vec3::UnitX()));
  const Vec3 shift(0.2, 0.2, 0.2), turn(1, 1, 1);
  const Vec3 axis = pose_at(20, -10).R * Vec3::UnitX();
  Mat6 claimed = covariance_of(shift, turn);
  claimed.topLeftCorner<3, 3>() += 10 * axis * axis.transpose();
  const Measured m = measure(PoseNoise(shift, turn), pin.same(), claimed, 50);
  const Repeatability& r = m.repeatability;
  ASSERT_GT(std::abs(axis.x()), 0.9);
  EXPECT_TRUE(r.unobservable[3]);
  EXPECT_FALSE(r.unobservable[4]);
  EXPECT_FALSE(r.unobservable[5]);
  EXPECT_EQ(r.claim(3), 0);
  for (int d : {0, 1, 2, 4, 5}) EXPECT_NEAR(r.claim(d), 1, 0.06) << d;
}

TEST(Repeatability, SummaryIsMedianAndWorstOfWhatCanBeSeen) {
  std::vector<Repeatability> parts(3);
  for (std::size_t i = 0; i < 3; ++i) {
    parts[i].sigma.fill(static_cast<double>(i + 1));
    parts[i].claimed.fill(6);
  }
  parts[2].unobservable[5] = true;
  const DirectionSummary s = summarize(parts);
  EXPECT_EQ(s.median[0], 2);
  EXPECT_EQ(s.worst[0], 3);
  EXPECT_EQ(s.claim[0], 3);
  EXPECT_EQ(s.median[5], 1.5);
  EXPECT_EQ(s.worst[5], 2);
  EXPECT_EQ(s.claim[5], 4.5);
}

}  // namespace
}  // namespace binpick::app
