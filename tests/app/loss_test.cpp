// Each cause of a fault, from findings made up so that the cause is known.
#include "eval/loss.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "eval/fault_analysis.hpp"
#include "eval/fault_pictures.hpp"
#include "eval/fault_tables.hpp"

using testing::HasSubstr;

namespace binpick::app {
namespace {

constexpr double kThreshold = 0.5;

// A part that is well measured, would be reported from the truth, and was seen up to `last`.
TargetFinding seen_until(int last) {
  TargetFinding t;
  t.frame = {1, 0};
  t.obj_id = 1;
  for (int i = 0; i < kCheckpointCount; ++i)
    t.finding.sightings[static_cast<std::size_t>(i)] = {i <= last ? 3 : -1, 40};
  OracleStart& start = t.finding.from_truth;
  start.posed = true;
  start.error = 0.1;
  start.rank = 100;
  start.detection.score = 0.9;
  start.detection.contour_support = 0.8;
  t.finding.from_template = start;
  t.moved.silhouette_px = t.moved.measured_px = 1000;
  return t;
}

TargetFinding seen_until(Checkpoint last) {
  return seen_until(static_cast<int>(last));
}

LossCause cause(const TargetFinding& t) {
  return cause_of(t, false, kThreshold, kThreshold);
}

void add_owner(TargetFinding& t, double advantage_px) {
  t.finding.has_owner = true;
  t.finding.owner_share = 0.9;
  t.finding.owner.score = 0.8;
  t.finding.owner.contour_support = 0.8;
  t.owner = t.moved;
  t.owner.advantage_px = advantage_px;
}

TEST(Loss, IsNoneForWhatWasFound) {
  EXPECT_EQ(cause_of(seen_until(Checkpoint::kAccepted), true, kThreshold, kThreshold).loss,
            Loss::kNone);
}

TEST(Loss, GoesToTheStageAfterTheLastSighting) {
  EXPECT_EQ(cause(seen_until(-1)).loss, Loss::kSearch);
  EXPECT_THAT(cause(seen_until(-1)).why, HasSubstr("scan: nothing near"));
  EXPECT_EQ(cause(seen_until(Checkpoint::kScanned)).loss, Loss::kSearch);
  EXPECT_THAT(cause(seen_until(Checkpoint::kScanned)).why, HasSubstr("scan: found, but beyond"));
  EXPECT_THAT(cause(seen_until(Checkpoint::kSelected1)).why, HasSubstr("descent 2: nothing"));
  EXPECT_EQ(cause(seen_until(Checkpoint::kSelected3)).loss, Loss::kRefinement);
  EXPECT_EQ(cause(seen_until(Checkpoint::kScored)).loss, Loss::kSuppression);
  EXPECT_THAT(cause(seen_until(Checkpoint::kScored)).why, HasSubstr("number 4 of 40"));
  EXPECT_EQ(cause(seen_until(Checkpoint::kScoreSelected)).loss, Loss::kRefinement);
  EXPECT_EQ(cause(seen_until(Checkpoint::kAlignedCoarse)).loss, Loss::kSuppression);
  EXPECT_EQ(cause(seen_until(Checkpoint::kCoarseSelected)).loss, Loss::kRefinement);
  EXPECT_EQ(cause(seen_until(Checkpoint::kAlignedFine)).loss, Loss::kSuppression);
}

// A tree that begins deeper has no third descent: the stage after it is scoring.
TEST(Loss, SkipsStagesThatWereNotPassed) {
  TargetFinding t = seen_until(Checkpoint::kSelected2);
  t.finding.sightings[static_cast<std::size_t>(Checkpoint::kDescended3)] = {};
  t.finding.sightings[static_cast<std::size_t>(Checkpoint::kSelected3)] = {};
  EXPECT_THAT(cause(t).why, HasSubstr("scoring"));
}

TEST(Loss, TellsVerificationFromRankingInTheExplanation) {
  TargetFinding t = seen_until(Checkpoint::kFineSelected);
  t.finding.last_drop = DropReason::kOverlapsBetter;
  EXPECT_EQ(cause(t).loss, Loss::kRanking);
  t.finding.last_drop = DropReason::kBelowMinScore;
  EXPECT_EQ(cause(t).loss, Loss::kVerification);
  EXPECT_THAT(cause(t).why, HasSubstr("below min score"));
  EXPECT_EQ(cause(seen_until(Checkpoint::kAccepted)).loss, Loss::kVerification);
}

// What stops a pose begun at the truth counts first, wherever the search lost it.
TEST(Loss, CountsWhatStopsEvenTheTruth) {
  TargetFinding t = seen_until(Checkpoint::kScanned);
  t.finding.from_truth.detection.score = 0.2;
  EXPECT_EQ(cause(t).loss, Loss::kVerification);
  EXPECT_THAT(cause(t).why, HasSubstr("in the run search"));
  EXPECT_EQ(cause_of(t, false, kThreshold, 0.1).loss, Loss::kSearch)
      << "enough, were all begun at the truth";
  t = seen_until(Checkpoint::kScanned);
  t.finding.from_truth.outranked = true;
  EXPECT_EQ(cause(t).loss, Loss::kRanking);
  t = seen_until(Checkpoint::kScanned);
  t.finding.from_truth.objected = true;
  t.finding.from_truth.objection = DropReason::kContradicted;
  EXPECT_EQ(cause(t).loss, Loss::kVerification);
  EXPECT_THAT(cause(t).why, HasSubstr("contradicted"));
}

TEST(Loss, BlamesTheDataWhereTheyDoNotTell) {
  TargetFinding t = seen_until(Checkpoint::kFineSelected);
  add_owner(t, 2);
  EXPECT_EQ(cause(t).loss, Loss::kData);
  add_owner(t, 60);
  EXPECT_NE(cause(t).loss, Loss::kData) << "the depth tells the truth from it";
  add_owner(t, 2);
  t.finding.owner.contour_support = 0.6;
  EXPECT_NE(cause(t).loss, Loss::kData) << "the outline tells";
  add_owner(t, 2);
  t.finding.owner_share = 0.2;
  EXPECT_NE(cause(t).loss, Loss::kData) << "it stands beside";
  t = seen_until(-1);
  t.moved.measured_px = 50;
  EXPECT_EQ(cause(t).loss, Loss::kData);
}

TEST(Loss, TellsRefinementFromDataAndFromAWrongTruth) {
  TargetFinding t = seen_until(Checkpoint::kAlignedCoarse);
  t.finding.from_truth.error = 2.5;
  t.moved.advantage_px = 80;
  EXPECT_EQ(cause(t).loss, Loss::kRefinement) << "it leaves a truth that fits better";
  t.moved.advantage_px = 1;
  EXPECT_EQ(cause(t).loss, Loss::kData);
  t.moved.advantage_px = -80;
  EXPECT_EQ(cause(t).loss, Loss::kTruth);
}

// A part of one frame: an L of three boxes would do; a tetrahedron without symmetry is simpler.
PartGeometry some_part() {
  train::Mesh mesh;
  mesh.vertices_mm = {{0, 0, 0}, {40, 0, 0}, {0, 25, 0}, {0, 0, 12}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  drivers::BopModel model;
  model.diameter_mm = 48;
  return PartGeometry(model, mesh);
}

const Pose kTruth{Mat3::Identity(), Vec3(0, 0, 600)};

FalsePickKind kind_of(const Vec3& turn_rad, const Vec3& shift_mm) {
  const std::vector<ScoredInstance> instances{{{1, kTruth, 0.9}, true}};
  const Pose estimate{rotation_from_vector(turn_rad), kTruth.t_mm + shift_mm};
  return classify_false_pick(some_part(), 1, estimate, instances, {}).kind;
}

TEST(FalsePick, IsNamedByWhatItIsMostLike) {
  EXPECT_EQ(kind_of({0, 0, 0}, {1, 0, 0}), FalsePickKind::kRepeated);
  EXPECT_EQ(kind_of({0, 0, 0}, {9, 0, 0}), FalsePickKind::kSlid);
  EXPECT_EQ(kind_of({0, 0, 0.5}, {1, 0, 0}), FalsePickKind::kTurned);
  EXPECT_EQ(kind_of({0, 3.1, 0}, {1, 0, 0}), FalsePickKind::kFlipped);
  EXPECT_EQ(kind_of({0, 0, 0.5}, {15, 0, 0}), FalsePickKind::kAdrift);
  EXPECT_EQ(kind_of({0, 0, 0}, {60, 0, 0}), FalsePickKind::kClutter);
}

// Turned right round in its place, beside a neighbour whose pose is nearer in angle.
TEST(FalsePick, IsComparedWithThePartThatItStandsIn) {
  const Pose neighbour{rotation_from_vector(Vec3(0, 0, 2.6)), Vec3(20, 0, 600)};
  const std::vector<ScoredInstance> instances{{{1, neighbour, 0.9}, true},
                                              {{1, kTruth, 0.9}, true}};
  const Pose estimate{rotation_from_vector(Vec3(0, 0, 3.1)), kTruth.t_mm};
  const FalsePick pick = classify_false_pick(some_part(), 1, estimate, instances, {});
  EXPECT_EQ(pick.instance, 1);
  EXPECT_EQ(pick.kind, FalsePickKind::kFlipped);
}

// Two parts to find; one is found, one is lost in the scan; and a false pick that stands where the
// lost one would be.
struct Case {
  Case() {
    truth[{1, 0}] = {{{1, kTruth, 0.9}, true},
                     {{1, {Mat3::Identity(), Vec3(100, 0, 600)}, 0.8}, true}};
    rows = {{{1, 0}, 1, 0.9, kTruth, 0.1},
            {{1, 0}, 1, 0.8, {rotation_from_vector(Vec3(0, 0, 0.5)), Vec3(100, 0, 600)}, 0.1}};
    score = score_results(geometry, truth, rows, {}, {});
    for (int i = 0; i < 2; ++i) {
      targets.push_back(seen_until(i == 0 ? Checkpoint::kAccepted : Checkpoint::kScanned));
      targets.back().instance = i;
    }
    add_owner(targets[1], 100);
    targets[1].finding.owner.T_cam_obj = rows[1].T_cam_obj;
  }
  std::vector<PartFaults> faults() const {
    return analyse_faults(score, truth, geometry, rows, targets);
  }

  std::map<int, PartGeometry> geometry{{1, some_part()}};
  TruthByFrame truth;
  std::vector<ResultRow> rows;
  ScoreReport score;
  std::vector<TargetFinding> targets;
};

TEST(FaultAnalysis, CountsEveryMissAndEveryFalsePick) {
  Case c;
  c.rows[1].score = 0.95;  // above the right one, so that the best threshold admits both
  c.score = score_results(c.geometry, c.truth, c.rows, {}, {});
  const std::vector<PartFaults> parts = c.faults();
  ASSERT_EQ(parts.size(), 1u);
  const PartFaults& p = parts[0];
  EXPECT_EQ(p.targets, 2);
  EXPECT_EQ(p.found, 1);
  ASSERT_EQ(p.missed.size(), 1u);
  EXPECT_EQ(p.missed[0].target->instance, 1);
  EXPECT_EQ(p.lost[static_cast<std::size_t>(Loss::kSearch)], 1);
  ASSERT_EQ(p.wrong.size(), 1u);
  EXPECT_EQ(p.wrong[0].kind, FalsePickKind::kTurned);
  EXPECT_EQ(p.wrong[0].instance, 1);
}

TEST(FaultAnalysis, BegunAtTheTruthAPartTakesThePlaceOfTheFalsePick) {
  Case c;
  EXPECT_DOUBLE_EQ(c.faults()[0].from_truth.f1, 1.0);
  c.targets[1].finding.from_truth.outranked = true;
  EXPECT_NEAR(c.faults()[0].from_truth.f1, 2.0 / 3, 1e-9);
}

TEST(FaultAnalysis, ShowsOneFaultOfEachCauseFirst) {
  Case c;
  const std::vector<PartFaults> parts = c.faults();
  PartFaults many = parts[0];
  many.missed.insert(many.missed.end(), 3, many.missed[0]);
  many.missed.back().cause.loss = Loss::kRanking;
  const std::vector<PartFaults> both{many};
  const std::vector<Fault> shown = faults_to_show(both, 2);
  ASSERT_EQ(shown.size(), 2u);
  EXPECT_EQ(shown[0].missed->cause.loss, Loss::kSearch);
  EXPECT_EQ(shown[1].missed->cause.loss, Loss::kRanking);
}

TEST(FaultTables, CarryTheSameNumbersInTextHtmlAndJson) {
  const Case c;
  const std::vector<PartFaults> parts = c.faults();
  const std::string text = fault_table(parts);
  EXPECT_THAT(text, HasSubstr("obj 1, 1/0 #1, 80 % visible: search: scan: found, but beyond"));
  EXPECT_THAT(reach_section_html(parts), HasSubstr("<td>obj 1</td><td>2</td>"));
  EXPECT_THAT(cause_section_html(parts, c.truth, c.rows), HasSubstr("search: scan"));
  const nlohmann::json out = faults_to_json(parts, c.rows);
  EXPECT_EQ(out[0]["lost_to"]["search"], 1);
  EXPECT_EQ(out[0]["missed"][0]["seen"]["scanned"]["place"], 3);
  EXPECT_EQ(out[0]["from_truth"]["f1"], 1.0);
  EXPECT_EQ(reach_section_html({}), "");
}

}  // namespace
}  // namespace binpick::app
