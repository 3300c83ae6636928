// Which detections of different frames are the same part.
#include "assess/tracks.hpp"

#include <gtest/gtest.h>

#include "scattered_poses.hpp"

namespace binpick::app {
namespace {

const Vec3 kNoise_mm(0.2, 0.2, 0.2), kNoise_deg(0.5, 0.5, 0.5);

std::vector<Track> tracks_of(const std::vector<Observation>& poses, const SamePose& part) {
  return find_tracks(poses, {&part, 1});
}

std::vector<std::size_t> sizes(const std::vector<Track>& tracks) {
  std::vector<std::size_t> out;
  for (const Track& track : tracks) out.push_back(track.seen.size());
  return out;
}

TEST(Tracks, APartIsFollowedThroughTheFramesThatMissIt) {
  PoseNoise noise(kNoise_mm, kNoise_deg);
  std::vector<Observation> poses;
  for (int frame = 0; frame < 10; ++frame) {
    poses.push_back(observation(frame, noise(pose_at(0, 0))));
    if (frame != 0 && frame != 6) poses.push_back(observation(frame, noise(pose_at(50, 10))));
  }
  poses.push_back(observation(4, pose_at(-60, 0)));  // once, by chance
  const std::vector<Track> tracks = tracks_of(poses, MadeUpPart{}.same());
  ASSERT_EQ(sizes(tracks), (std::vector<std::size_t>{10, 8, 1}));
  EXPECT_LT((tracks[0].mean.t_mm - pose_at(0, 0).t_mm).norm(), 0.3);
  EXPECT_LT((tracks[1].mean.t_mm - pose_at(50, 10).t_mm).norm(), 0.3);
}

TEST(Tracks, PosesThatASymmetryMakesTheSameAreOnePart) {
  MadeUpPart hexagon;
  for (int i = 1; i < 6; ++i) hexagon.exact_turns.push_back(turn_row(Vec3::UnitZ(), 60.0 * i));
  PoseNoise noise(kNoise_mm, kNoise_deg);
  std::vector<Observation> poses;
  for (int frame = 0; frame < 12; ++frame)
    poses.push_back(observation(frame, turned(noise(pose_at(0, 0)), Vec3::UnitZ(), 60 * frame)));
  const std::vector<Track> tracks = tracks_of(poses, hexagon.same());
  ASSERT_EQ(sizes(tracks), std::vector<std::size_t>{12});
  for (const Pose& pose : tracks[0].poses)
    EXPECT_LT(rotation_angle_between(pose.R, tracks[0].mean.R), 3 * kDegree);
  EXPECT_EQ(flips_of(tracks[0], poses, hexagon.same()), 0) << "the part is the same";
  EXPECT_GT(tracks_of(poses, MadeUpPart{}.same()).size(), 1u);
}

TEST(Tracks, AnyAngleAboutAnAxisOfThePartIsTheSame) {
  MadeUpPart pin;
  pin.exact_axes.push_back(axis_row(Vec3::UnitX()));
  pin.exact_turns.push_back(turn_row(Vec3::UnitZ(), 180));
  PoseNoise noise(kNoise_mm, kNoise_deg);
  std::vector<Observation> poses;
  for (int frame = 0; frame < 12; ++frame) {
    const Pose rolled = turned(noise(pose_at(0, 0)), Vec3::UnitX(), 77.0 * frame);
    poses.push_back(observation(frame, turned(rolled, Vec3::UnitZ(), 180 * (frame % 2))));
  }
  EXPECT_EQ(sizes(tracks_of(poses, pin.same())), std::vector<std::size_t>{12});
}

TEST(Tracks, NearSymmetriesAreOneWhereTheyCountAsOneAndFlipsAreCounted) {
  MadeUpPart housing;
  housing.near_turns.push_back(turn_row(Vec3::UnitY(), 180, 0, SymmetryKind::kIndistinguishable));
  MadeUpPart plate;
  plate.near_turns.push_back(turn_row(Vec3::UnitY(), 180, 0, SymmetryKind::kNear));
  PoseNoise noise(kNoise_mm, kNoise_deg);
  std::vector<Observation> poses;
  for (int frame = 0; frame < 10; ++frame) {
    const bool flip = frame == 2 || frame == 3 || frame == 8;
    poses.push_back(observation(frame, turned(noise(pose_at(0, 0)), Vec3::UnitY(), flip ? 180 : 0),
                                flip ? 0.99 : 0.8));
  }
  const std::vector<Track> tracks = tracks_of(poses, housing.same());
  ASSERT_EQ(sizes(tracks), std::vector<std::size_t>{10});
  EXPECT_EQ(flips_of(tracks[0], poses, housing.same()), 3);
  EXPECT_EQ(sizes(tracks_of(poses, housing.same(NearSymmetry::kDistinct))),
            (std::vector<std::size_t>{7, 3}));
  EXPECT_EQ(sizes(tracks_of(poses, plate.same())), (std::vector<std::size_t>{7, 3}));
  EXPECT_EQ(sizes(tracks_of(poses, plate.same(NearSymmetry::kEquivalent))),
            std::vector<std::size_t>{10});
}

// Two flat parts on each other, nearer than what is one part; in the first frames only one of
// either is found.
TEST(Tracks, PartsCloseTogetherKeepTheirPoses) {
  PoseNoise noise(Vec3(0.1, 0.1, 0.1), kNoise_deg);
  const Pose low = pose_at(0, 0), high = pose_at(3, 2);
  std::vector<Observation> poses;
  std::vector<bool> is_high;
  for (int frame = 0; frame < 10; ++frame) {
    for (const bool of_high : {false, true}) {
      if ((frame == 0 && of_high) || (frame == 1 && !of_high)) continue;
      poses.push_back(observation(frame, noise(of_high ? high : low)));
      is_high.push_back(of_high);
    }
  }
  const std::vector<Track> tracks = tracks_of(poses, MadeUpPart{}.same());
  ASSERT_EQ(sizes(tracks), (std::vector<std::size_t>{9, 9}));
  for (const Track& track : tracks) {
    for (const std::size_t i : track.seen) EXPECT_EQ(is_high[i], is_high[track.seen.front()]);
  }
}

TEST(Tracks, PartsOfDifferentKindsAreNeverOne) {
  const std::vector<SamePose> parts{MadeUpPart{}.same(), MadeUpPart{}.same()};
  std::vector<Observation> poses{observation(0, pose_at(0, 0)), observation(1, pose_at(0, 0))};
  poses[1].model = 1;
  EXPECT_EQ(find_tracks(poses, parts).size(), 2u);
}

}  // namespace
}  // namespace binpick::app
