// From templates to poses on the measured surface.
#include "pose/score_candidates.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "pose/ray_pose.hpp"
#include "seen_bracket.hpp"

namespace binpick {
namespace {

// A leaf seen in the middle of the image.
Candidate leaf_in_the_middle() {
  Candidate c;
  c.x = 56;
  c.y = 44;
  c.level = 2;
  c.viewpoint = 9;
  c.roll = 5;
  c.score = kScoreOne;
  return c;
}

// Of the part's centre.
Pose leaf_pose() {
  static const SeenBracket any(bracket_pose(0, 0, 0, {0, 0, 500}));
  const ObjectModel& model = bracket_model();
  return candidate_pose(model, model.depth_count() - 1, leaf_in_the_middle(), any.pyramid);
}

// The part's own origin where its centre is at a pose.
Pose origin_of(Pose T_cam_centre) {
  T_cam_centre.t_mm -= T_cam_centre.R * bracket_model().centre_mm();
  return T_cam_centre;
}

// A part at this pose, and the leaf.
struct Scored {
  explicit Scored(const Pose& T_cam_centre)
      : bracket(origin_of(T_cam_centre), bracket_model(), 0.1) {}

  Hypothesis leaf(const Deadline& deadline = {}) {
    const Candidate candidate = leaf_in_the_middle();
    Hypothesis out;
    const Scene scene = bracket.scene();
    PoseContext context = bracket.context(scene);
    context.deadline = deadline;
    score_candidates(context, {&candidate, 1}, bracket.pyramid, {&out, 1});
    return out;
  }

  SeenBracket bracket;
};

TEST(ScoreCandidates, FindTheSurfaceAlongTheirRay) {
  for (const double off_mm : {-25.0, -10.0, 0.0, 10.0, 25.0}) {
    Pose T = leaf_pose();
    T.t_mm *= 1 + off_mm / T.t_mm.z();
    const Hypothesis h = Scored(T).leaf();
    ASSERT_TRUE(h.alive) << off_mm;
    const Vec3& found = h.T_cam_centre.t_mm;
    EXPECT_LT((found - T.t_mm).norm(), 2) << off_mm;
    EXPECT_LT(found.cross(T.t_mm).norm() / T.t_mm.norm(), 1e-6) << "left its ray";
    EXPECT_GT(h.rank, 0.5 * kScoreOne) << off_mm;
  }
}

TEST(ScoreCandidates, RankBelowWhereTheSurfaceIsAnother) {
  Scored there(leaf_pose()), turned(leaf_pose() * Pose{rotation_from_vector({0, 0, 2}), {}});
  EXPECT_LT(turned.leaf().rank, 0.7 * there.leaf().rank);
}

TEST(ScoreCandidates, DropWhatFindsNoSurface) {
  Scored scored(leaf_pose());
  std::fill(scored.bracket.images.depth_mm.begin(), scored.bracket.images.depth_mm.end(), 0.0f);
  scored.bracket.look();
  const Hypothesis h = scored.leaf();
  EXPECT_FALSE(h.alive);
  EXPECT_EQ(h.drop_reason, DropReason::kPoseDiverged);
}

TEST(ScoreCandidates, WithoutDepthEdgesOfTheContoursDirectionCount) {
  Scored there(leaf_pose()), elsewhere(leaf_pose() * Pose{Mat3::Identity(), {0, 60, 0}});
  there.bracket.without_depth();
  elsewhere.bracket.without_depth();
  const Hypothesis good = there.leaf(), bad = elsewhere.leaf();
  EXPECT_GT(good.rank, 0.25) << "beyond chance";
  EXPECT_LT(bad.rank, 0.5 * good.rank);
  EXPECT_EQ(leaf_pose().t_mm, good.T_cam_centre.t_mm) << "the distance is the template's";
}

TEST(ScoreCandidates, DropWhatTheDeadlineCuts) {
  Scored scored(leaf_pose());
  const Hypothesis h = scored.leaf({[]() -> std::int64_t { return 2; }, 1});
  EXPECT_FALSE(h.alive);
  EXPECT_EQ(h.drop_reason, DropReason::kDeadline);
}

}  // namespace
}  // namespace binpick
