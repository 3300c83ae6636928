// What a diagnosis sees of a detection, and that the detection does not see the diagnosis.
#include "binpick/diagnosis/diagnosis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "detector_rig.hpp"

namespace binpick {
namespace {

struct DiagnosisRig : DetectorRig {
  explicit DiagnosisRig(std::vector<ObjectModel> parts = {bracket_model()})
      : DetectorRig(kLimits, {}, 1, nullptr, std::move(parts)) {}

  Result<DetectionReport> diagnosed(const Frame& frame, const std::vector<Pose>& poses,
                                    std::vector<ReferenceFinding>& findings) {
    std::vector<ReferencePose> references;
    for (const Pose& p : poses) references.push_back({0, {&p, 1}});
    findings.assign(poses.size(), {});
    return diagnose(detector, frame, request, references, {}, findings);
  }

  DetectRequest request;
};

const Sighting& at(const ReferenceFinding& f, Checkpoint c) {
  return f.sightings[static_cast<std::size_t>(c)];
}

TEST(Diagnosis, FollowsAFoundPartToTheEnd) {
  const BracketScene scene = render_brackets(bracket_camera(), three_brackets(), 0.1);
  DiagnosisRig rig;
  std::vector<ReferenceFinding> findings;
  ASSERT_TRUE(rig.diagnosed(scene.frame(), scene.truth, findings).ok());
  for (const ReferenceFinding& f : findings) {
    for (const Checkpoint c :
         {Checkpoint::kScanned, Checkpoint::kScanSelected, Checkpoint::kScored,
          Checkpoint::kScoreSelected, Checkpoint::kAlignedCoarse, Checkpoint::kCoarseSelected,
          Checkpoint::kAlignedFine, Checkpoint::kFineSelected, Checkpoint::kAccepted}) {
      EXPECT_TRUE(at(f, c).seen()) << checkpoint_name(c);
      EXPECT_LT(at(f, c).place, at(f, c).count) << checkpoint_name(c);
    }
    EXPECT_TRUE(f.from_truth.right());
    EXPECT_TRUE(f.from_truth.reported());
    EXPECT_GT(f.from_truth.detection.score, 0.5);
    EXPECT_TRUE(f.from_template.right());
    EXPECT_TRUE(f.from_template.reported());
    EXPECT_LT(f.owner_share, 0.1) << "nothing else stands in its place";
    int searched = 0;
    for (const double score : f.template_scores) {
      searched += score >= 0;
      if (score >= 0) {
        EXPECT_GT(score, 0.9) << "the search's own threshold";
      }
    }
    EXPECT_GE(searched, 2);
  }
}

double log_odds(double score) {
  return std::log(score / (1 - score));
}

// Two parts of one shape: whatever explains the one explains the other.
TEST(Diagnosis, ScoresThePoseFromTheTruthBesideItsConflicts) {
  const BracketScene scene = render_brackets(bracket_camera(), three_brackets(), 0.1);
  DiagnosisRig alone, twice({bracket_model(), bracket_model()});
  std::vector<ReferenceFinding> without_conflict, with_conflict;
  ASSERT_TRUE(alone.diagnosed(scene.frame(), scene.truth, without_conflict).ok());
  const auto report = twice.diagnosed(scene.frame(), scene.truth, with_conflict);
  ASSERT_TRUE(report.ok());
  for (std::size_t i = 0; i < scene.truth.size(); ++i) {
    const double score = with_conflict[i].from_truth.detection.score;
    EXPECT_LT(log_odds(score), log_odds(without_conflict[i].from_truth.detection.score) - 1);
    const auto found = report.value().detections;
    EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const Detection& d) {
      return pose_error(d.T_cam_obj, scene.truth[i]).within(1, 1) &&
             std::abs(d.score - score) < 0.002;
    }));
  }
}

TEST(Diagnosis, ChangesNothingOfTheDetection) {
  const BracketScene scene = render_brackets(bracket_camera(), three_brackets(), 0.1);
  DiagnosisRig plain, watched;
  const auto a = plain.detector.detect(scene.frame(), plain.request);
  std::vector<ReferenceFinding> findings;
  const auto b = watched.diagnosed(scene.frame(), scene.truth, findings);
  ASSERT_TRUE(a.ok() && b.ok());
  ASSERT_EQ(a.value().detections.size(), b.value().detections.size());
  EXPECT_EQ(a.value().dropped, b.value().dropped);
  EXPECT_EQ(a.value().candidates, b.value().candidates);
  for (std::size_t i = 0; i < a.value().detections.size(); ++i) {
    const Detection &x = a.value().detections[i], &y = b.value().detections[i];
    EXPECT_EQ(x.T_cam_obj.R, y.T_cam_obj.R);
    EXPECT_EQ(x.T_cam_obj.t_mm, y.T_cam_obj.t_mm);
    EXPECT_EQ(x.score, y.score);
  }
}

// Where there is no part nothing is followed to the end, and a start there is not reported.
TEST(Diagnosis, LosesAPartThatIsNotThere) {
  const BracketScene scene = render_brackets(bracket_camera(), three_brackets(), 0.1);
  Pose elsewhere = scene.truth.front();
  elsewhere.t_mm.z() -= 60;  // in the air: the table lies behind it
  DiagnosisRig rig;
  std::vector<ReferenceFinding> findings;
  ASSERT_TRUE(rig.diagnosed(scene.frame(), {elsewhere}, findings).ok());
  EXPECT_FALSE(at(findings[0], Checkpoint::kAccepted).seen());
  EXPECT_FALSE(findings[0].from_truth.right() && findings[0].from_truth.reported());
}

// A part that another one hides but for a rim: the stage that gives it up is named.
TEST(Diagnosis, NamesWhatSpeaksAgainstAHiddenPart) {
  std::vector<Pose> poses{three_brackets().front()};
  BracketScene scene = render_brackets(bracket_camera(), poses, 0.1);
  const Vec2 centre = scene.camera.project(poses.front().t_mm);
  // A lid 100 mm above everything.
  for (int y = 0; y < scene.camera.height; ++y) {
    for (int x = 0; x < scene.camera.width; ++x) {
      if (std::abs(x - centre.x()) < 100 && std::abs(y - centre.y()) < 100)
        scene.depth_mm[static_cast<std::size_t>(y * scene.camera.width + x)] = 380;
    }
  }
  DiagnosisRig rig;
  std::vector<ReferenceFinding> findings;
  ASSERT_TRUE(rig.diagnosed(scene.frame(), poses, findings).ok());
  EXPECT_FALSE(at(findings[0], Checkpoint::kAccepted).seen());
  ASSERT_TRUE(findings[0].from_truth.posed);
  EXPECT_TRUE(findings[0].from_truth.objected);
  EXPECT_EQ(findings[0].from_truth.objection, DropReason::kTooHidden);
}

// Of the poses that look alike the nearest counts.
TEST(Diagnosis, AcceptsAnyOfThePosesThatLookAlike) {
  const BracketScene scene = render_brackets(bracket_camera(), three_brackets(), 0.1);
  const std::vector<Pose> alike{
      {Mat3(scene.truth[0].R * rotation_from_vector(Vec3(0, 0, 1.5))), scene.truth[0].t_mm},
      scene.truth[0]};
  for (const std::size_t count : {1u, 2u}) {
    const ReferencePose reference{0, {alike.data(), count}};
    ReferenceFinding finding;
    DiagnosisRig rig;
    ASSERT_TRUE(
        diagnose(rig.detector, scene.frame(), rig.request, {&reference, 1}, {}, {&finding, 1})
            .ok());
    EXPECT_EQ(at(finding, Checkpoint::kAccepted).seen(), count == 2);
  }
}

}  // namespace
}  // namespace binpick
