#include "eval/score.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "eval/assignment.hpp"

namespace binpick::app {
namespace {

// A box with one corner pulled out, so that it has no symmetry of its own.
train::Mesh lopsided_box() {
  train::Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_mm.emplace_back(i & 1 ? 20.f : -20.f, i & 2 ? 15.f : -15.f, i & 4 ? 10.f : -10.f);
  }
  mesh.vertices_mm[7] *= 1.4f;
  for (const auto& quad : {std::array{0u, 2u, 3u, 1u},
                           {4u, 5u, 7u, 6u},
                           {0u, 1u, 5u, 4u},
                           {2u, 6u, 7u, 3u},
                           {0u, 4u, 6u, 2u},
                           {1u, 3u, 7u, 5u}}) {
    mesh.triangles.push_back({quad[0], quad[1], quad[2]});
    mesh.triangles.push_back({quad[0], quad[2], quad[3]});
  }
  return mesh;
}

Pose half_turn_about_z() {
  return {rotation_from_vector({0, 0, kPi}), Vec3::Zero()};
}

drivers::BopModel plain_model() {
  drivers::BopModel model;
  model.obj_id = 1;
  model.diameter_mm = 60;
  return model;
}

PartGeometry plain_part() {
  return PartGeometry(plain_model(), lopsided_box());
}

Pose pose_at(double x_mm) {
  return {rotation_from_vector({0.4, -0.9, 0.3}), Vec3(x_mm, 20, 700)};
}

Pose turned(const Pose& pose, const Vec3& axis, double degrees) {
  return {rotation_from_vector(axis * degrees * kDegree) * pose.R, pose.t_mm};
}

Pose shifted(const Pose& pose, const Vec3& by_mm) {
  return {pose.R, pose.t_mm + by_mm};
}

// Scores detections in one frame of part 1 against instances with the given visible fractions, 100
// mm apart.
class OneFrame {
 public:
  explicit OneFrame(const std::vector<double>& visible) {
    for (std::size_t i = 0; i < visible.size(); ++i) {
      truth_[kFrame].push_back({{1, instance(i), visible[i]}, true});
    }
  }
  static Pose instance(std::size_t i) { return pose_at(100.0 * static_cast<double>(i)); }

  OneFrame& detect(double score, const Pose& pose) {
    rows_.push_back({kFrame, 1, score, pose, 0.1});
    return *this;
  }
  void put_outside_roi(std::size_t i) { truth_[kFrame][i].origin_in_roi = false; }

  PartScore score(std::optional<double> fixed_threshold = {}) const {
    std::map<int, PartGeometry> geometry;
    geometry.emplace(1, plain_part());
    ScoreOptions options;
    options.fixed_threshold = fixed_threshold;
    return score_results(geometry, truth_, rows_, times_of_frames(rows_), options).parts.at(0);
  }

 private:
  static constexpr drivers::FrameId kFrame{1, 0};
  TruthByFrame truth_;
  std::vector<ResultRow> rows_;
};

TEST(PoseErrors, AreZeroForTheTruthItself) {
  const PoseError6 e = plain_part().six_errors(pose_at(5), pose_at(5), {});
  for (const double v : e) EXPECT_NEAR(v, 0, 1e-6);
}

TEST(PoseErrors, AreShiftAndRotationVectorInCameraAxes) {
  const Pose truth = pose_at(5);
  const Pose estimate = turned(shifted(truth, {1, -2, 3}), Vec3::UnitY(), -4);
  const PoseError6 e = plain_part().six_errors(estimate, truth, {});
  const PoseError6 expected{1, -2, 3, 0, -4, 0};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(e[i], expected[i], 1e-9) << i;
}

TEST(PoseErrors, MeasureHalfATurn) {
  const PoseError6 e =
      plain_part().six_errors(turned(pose_at(0), Vec3::UnitX(), 180), pose_at(0), {});
  EXPECT_NEAR(std::abs(e[3]), 180, 1e-6);
}

TEST(PoseErrors, TakeTheBestOfDiscreteSymmetries) {
  drivers::BopModel model = plain_model();
  model.symmetries_discrete = {half_turn_about_z()};
  const PartGeometry part(model, lopsided_box());
  const Pose truth = pose_at(5);
  EXPECT_LT(relative_error(part.six_errors(truth * half_turn_about_z(), truth, {}), {}), 1e-6);
  EXPECT_GT(relative_error(plain_part().six_errors(truth * half_turn_about_z(), truth, {}), {}), 5);
}

TEST(PoseErrors, ForgiveTurnsAboutAContinuousAxisAwayFromTheOrigin) {
  drivers::BopModel model = plain_model();
  model.symmetries_continuous = {{Vec3::UnitX(), Vec3(0, 4, -3)}};
  const PartGeometry part(model, lopsided_box());
  const Mat3 R = rotation_from_vector({1.234, 0, 0});
  const Vec3 offset(0, 4, -3);
  const Pose spin{R, offset - R * offset};
  const Pose truth = pose_at(5);
  EXPECT_LT(relative_error(part.six_errors(truth * spin, truth, {}), {}), 1e-6);
  const Pose off = shifted(truth * spin, {0, 0, 2});
  EXPECT_NEAR(relative_error(part.six_errors(off, truth, {}), {}), 2.0 / 5, 1e-6);
}

TEST(AddDistance, EqualsAPureShift) {
  EXPECT_NEAR(plain_part().add_mm(shifted(pose_at(0), {0, 3, 4}), pose_at(0)), 5, 1e-9);
}

TEST(AddDistance, OfASymmetricPartUsesNearestPoints) {
  drivers::BopModel model = plain_model();
  model.symmetries_discrete = {half_turn_about_z()};
  train::Mesh box = lopsided_box();
  box.vertices_mm[7] /= 1.4f;  // now the symmetry is true
  const PartGeometry part(model, box);
  const Pose truth = pose_at(0), flipped = truth * half_turn_about_z();
  EXPECT_LT(part.add_mm(flipped, truth), 2.5) << "about the spacing of the points";
  EXPECT_GT(PartGeometry(plain_model(), box).add_mm(flipped, truth), 20);
}

TEST(MssdDistance, IsTheLargestShiftOfAVertex) {
  const PartGeometry part = plain_part();
  EXPECT_NEAR(part.mssd_mm(shifted(pose_at(0), {0, 3, 4}), pose_at(0)), 5, 1e-9);
  const Pose spun = pose_at(0) * Pose{rotation_from_vector({0, 0, 10 * kDegree}), Vec3::Zero()};
  const double reach = Eigen::Vector2f(28, 21).norm();  // of the pulled corner from the z axis
  EXPECT_NEAR(part.mssd_mm(spun, pose_at(0)), 2 * std::sin(5 * kDegree) * reach, 1e-4);
}

TEST(SurfaceSampling, FollowsNumpysGeneratorOfSeedOne) {
  // numpy.random.default_rng(1): one triangle, so choice() spends one draw a point and decides
  // nothing; the next two draws place the first of two points.
  train::Mesh mesh;
  mesh.vertices_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  const std::vector<Vec3> points = sample_surface(mesh, 2);
  ASSERT_EQ(points.size(), 2u);
  const double third = 0.14415961271963373, fourth = 0.9486494471372439;
  EXPECT_NEAR(points[0].x(), std::sqrt(third) * (1 - fourth), 1e-15);
  EXPECT_NEAR(points[0].y(), std::sqrt(third) * fourth, 1e-15);
}

TEST(SurfaceSampling, SpreadsPointsByArea) {
  train::Mesh mesh;  // two triangles, the second with three times the area
  mesh.vertices_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {10, 0, 0}, {13, 0, 0}, {10, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  int second = 0;
  for (const Vec3& p : sample_surface(mesh, 4000)) second += p.x() > 5;
  EXPECT_NEAR(second, 3000, 120);
}

TEST(Scoring, FindsEverythingWithTruthAsDetections) {
  OneFrame frame({1, 0.8, 0.7});
  for (std::size_t i = 0; i < 3; ++i)
    frame.detect(0.9 - 0.1 * static_cast<double>(i), OneFrame::instance(i));
  const PartScore s = frame.score();
  EXPECT_EQ(s.best.f1, 1);
  EXPECT_EQ(s.add10.recall, 1);
  EXPECT_EQ(s.mssd_recall, 1);
  EXPECT_EQ(s.instances, 3);
  EXPECT_NEAR(*s.best.threshold, 0.7, 1e-12);
}

TEST(Scoring, CountsAPoseJustInsideEveryLimitAndNotJustOutsideOne) {
  const Pose truth = OneFrame::instance(0);
  const Pose inside = turned(shifted(truth, {4.9, -4.9, 4.9}), Vec3::UnitZ(), 7.4);
  EXPECT_EQ(OneFrame({1}).detect(1, inside).score().best.f1, 1);
  EXPECT_EQ(OneFrame({1}).detect(1, shifted(truth, {0, 5.1, 0})).score().best.f1, 0);
  EXPECT_EQ(OneFrame({1}).detect(1, turned(truth, Vec3::UnitX(), 7.6)).score().best.f1, 0);
}

TEST(Scoring, CountsADuplicateAsWrong) {
  const Pose truth = OneFrame::instance(0);
  const PartScore s =
      OneFrame({1}).detect(0.5, truth).detect(0.5, shifted(truth, {0.5, 0, 0})).score();
  EXPECT_EQ(s.best.recall, 1);
  EXPECT_EQ(s.best.precision, 0.5) << "tied scores stay together";
  const PartScore apart =
      OneFrame({1}).detect(0.6, truth).detect(0.5, shifted(truth, {0.5, 0, 0})).score();
  EXPECT_EQ(apart.best.f1, 1) << "a threshold between them leaves the duplicate out";
}

TEST(Scoring, LetsTheBetterScoreChooseFirst) {
  const Pose truth = OneFrame::instance(0);
  const PartScore s =
      OneFrame({1}).detect(0.3, truth).detect(0.8, shifted(truth, {4, 0, 0})).score();
  ASSERT_EQ(s.marks.size(), 2u);
  for (const DetectionMark& mark : s.marks) {
    EXPECT_EQ(mark.verdict, mark.row_index == 1 ? Verdict::kRight : Verdict::kWrong);
  }
}

TEST(Scoring, TakesHiddenAndOutsideInstancesForNeitherGoodNorBad) {
  OneFrame frame({1, 0.69, 1});
  frame.put_outside_roi(2);
  for (std::size_t i = 0; i < 3; ++i) frame.detect(0.5, OneFrame::instance(i));
  const PartScore s = frame.score();
  EXPECT_EQ(s.instances, 1);
  EXPECT_EQ(s.best.f1, 1);
  EXPECT_EQ(s.marks[1].verdict, Verdict::kNeutral);
  EXPECT_EQ(s.marks[2].verdict, Verdict::kNeutral);
}

TEST(Scoring, ReportsAFixedThresholdBesideTheBest) {
  OneFrame frame({1, 1});
  frame.detect(0.9, OneFrame::instance(0)).detect(0.4, OneFrame::instance(1));
  const PartScore s = frame.score(0.5);
  EXPECT_EQ(s.best.f1, 1);
  EXPECT_NEAR(s.fixed->f1, 2.0 / 3, 1e-12);
  EXPECT_EQ(s.fixed->precision, 1);
  EXPECT_EQ(s.fixed->recall, 0.5);
}

TEST(Scoring, AveragesErrorsOfRightPosesOnly) {
  OneFrame frame({1, 1});
  frame.detect(0.9, shifted(OneFrame::instance(0), {1, 0, -2}));
  frame.detect(0.8, shifted(OneFrame::instance(1), {-3, 0, 2}));
  frame.detect(0.7, shifted(OneFrame::instance(1), {50, 0, 0}));
  const PartScore s = frame.score();
  ASSERT_TRUE(s.mean_abs_error.has_value());
  EXPECT_NEAR((*s.mean_abs_error)[0], 2, 1e-9);
  EXPECT_NEAR((*s.mean_abs_error)[1], 0, 1e-9);
  EXPECT_NEAR((*s.mean_abs_error)[2], 2, 1e-9);
}

TEST(Scoring, OfNothingIsZeroAndNotAnError) {
  const PartScore s = OneFrame({1}).score();
  EXPECT_EQ(s.best.f1, 0);
  EXPECT_FALSE(s.best.threshold.has_value());
  EXPECT_FALSE(s.mean_abs_error.has_value());
  EXPECT_TRUE(s.curve.empty());
}

TEST(Scoring, ListsMixedScenesApart) {
  TruthByFrame truth;
  truth[{1, 0}] = {{{1, pose_at(0), 1}, true}};
  truth[{2, 0}] = {{{1, pose_at(0), 1}, true}, {{2, pose_at(100), 1}, true}};
  std::map<int, PartGeometry> geometry;
  geometry.emplace(1, plain_part());
  geometry.emplace(2, plain_part());
  const std::vector<ResultRow> rows{{{1, 0}, 1, 0.9, pose_at(0), -1}};
  const ScoreReport report = score_results(geometry, truth, rows, {}, {});
  ASSERT_EQ(report.parts.size(), 1u);
  ASSERT_EQ(report.mixed.size(), 2u);
  EXPECT_EQ(report.mean->best.f1, 1) << "mixed scenes do not enter the mean";
  EXPECT_EQ(report.mixed_mean->best.f1, 0);
  EXPECT_FALSE(report.mean->time.has_value());
}

TEST(Scoring, NamesAnObjectWithoutGeometry) {
  const TruthByFrame truth{{{1, 0}, {{{4, pose_at(0), 1}, true}}}};
  EXPECT_THROW(score_results({}, truth, {}, {}, {}), drivers::DatasetError);
}

TEST(Assignment, PrefersInstancesThatHaveToBeFound) {
  const PairErrors errors{{{0, 0.1}, {1, 0.5}}, {{0, 0.2}, {1, 0.1}}, {{0, 0.9}}};
  const std::vector<Match> matches = assign_greedily(errors, {false, true}, 1.0);
  EXPECT_EQ(matches[0].instance, 1);
  EXPECT_EQ(matches[0].verdict, Verdict::kRight);
  EXPECT_EQ(matches[1].instance, 0);
  EXPECT_EQ(matches[1].verdict, Verdict::kNeutral);
  EXPECT_EQ(matches[2].verdict, Verdict::kWrong) << "both were taken";
}

TEST(Times, HavePercentilesBetweenOrderStatistics) {
  const TimeSummary t = summarize_times({0.4, 0.1, 0.2, 0.3});
  EXPECT_NEAR(t.mean_s, 0.25, 1e-12);
  EXPECT_NEAR(t.p50_s, 0.25, 1e-12);
  EXPECT_NEAR(t.p99_s, 0.397, 1e-12);
  EXPECT_EQ(t.max_s, 0.4);
  EXPECT_EQ(summarize_times({}).count, 0);
}

}  // namespace
}  // namespace binpick::app
