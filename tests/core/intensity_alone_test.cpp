// Poses from intensity alone: of rendered parts, without any depth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "allocation_count.hpp"
#include "binpick/detect/detector.hpp"
#include "detector_rig.hpp"

namespace binpick {
namespace {

// The bracket is small in the image: what it explains is little, and so is its probability.
constexpr double kScoreMin = 0.02;

// So tilted that creases show: of a flat view the contour hardly tells the tilt.
std::vector<Pose> tilted_brackets() {
  return {bracket_pose(30, 40, 20, {-75, -35, 505}), bracket_pose(25, 200, 140, {60, -55, 490}),
          bracket_pose(28, 150, 260, {5, 55, 500})};
}

struct IntensityRig : DetectorRig {
  explicit IntensityRig(int threads = 1) : DetectorRig(kLimits, {}, threads) {}

  Result<DetectionReport> detect(const Frame& frame, Modality modality = Modality::kAutomatic,
                                 double min_score = kScoreMin) {
    DetectRequest request;
    request.modality = modality;
    request.min_score = min_score;
    return detector.detect(frame, request);
  }
  ErrorCode error_of(const Frame& frame, Modality modality) {
    const Result<DetectionReport> report = detect(frame, modality);
    return report.ok() ? ErrorCode::kNone : report.error().code;
  }
};

// Gray with the noise of a camera.
const BracketScene& scene() {
  static const BracketScene once = [] {
    BracketScene seen = render_brackets(bracket_camera(), tilted_brackets());
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 2);
    for (auto& g : seen.gray)
      g = static_cast<std::uint8_t>(std::clamp(std::lround(g + noise(random)), 0L, 255L));
    return seen;
  }();
  return once;
}

Frame without_depth(const BracketScene& seen) {
  Frame frame = seen.frame();
  frame.depth_mm = {};
  return frame;
}

const Detection* nearest(const DetectionReport& report, const Pose& truth) {
  const Detection* best = nullptr;
  double least_mm = 30;
  for (const Detection& d : report.detections) {
    const double mm = pose_error(d.T_cam_obj, truth).shift_mm;
    if (mm < least_mm) least_mm = mm, best = &d;
  }
  return best;
}

// What two answers must agree on.
void expect_same(const DetectionReport& a, const DetectionReport& b) {
  ASSERT_EQ(a.detections.size(), b.detections.size());
  for (std::size_t i = 0; i < a.detections.size(); ++i) {
    EXPECT_EQ(a.detections[i].T_cam_obj.R, b.detections[i].T_cam_obj.R);
    EXPECT_EQ(a.detections[i].T_cam_obj.t_mm, b.detections[i].T_cam_obj.t_mm);
    EXPECT_EQ(a.detections[i].score, b.detections[i].score);
    EXPECT_EQ(a.detections[i].uncertainty.covariance, b.detections[i].uncertainty.covariance);
  }
  EXPECT_EQ(a.candidates, b.candidates);
  EXPECT_EQ(a.dropped, b.dropped);
}

// Every part is found in the image. Where its contours fit nearly as well further back, tilted by
// 20 degrees more, distance and tilt may come out wrong. The score tells: the most probable pose is
// right, and what is wrong is at most half as probable.
TEST(IntensityAlone, FindsPartsAndTellsWhichDistanceToTrust) {
  IntensityRig rig;
  const DetectionReport report = rig.detect(without_depth(scene())).value();
  ASSERT_FALSE(report.detections.empty());
  const Detection& best = report.detections[0];
  for (const Pose& truth : scene().truth) {
    const Detection* d = nearest(report, truth);
    ASSERT_NE(d, nullptr);
    const Vec3 off = d->T_cam_obj.t_mm - truth.t_mm;
    const double angle_deg = pose_error(d->T_cam_obj, truth).angle_deg;
    const double stated_mm = d->uncertainty.weak_shift_mm;
    std::printf("[ measured ] %.2f %.2f %.2f mm, %.2f deg, +- %.2f mm, score %.3f\n", off.x(),
                off.y(), off.z(), angle_deg, stated_mm, d->score);
    const bool right = std::abs(off.x()) < 0.5 && std::abs(off.y()) < 0.5 &&
                       std::abs(off.z()) < 3 && std::abs(off.z()) < 3 * stated_mm && angle_deg < 2;
    if (!right) {
      EXPECT_LT(d->score, best.score / 2);
    }
    EXPECT_LT(std::hypot(off.x(), off.y()), 3);
    EXPECT_LT(std::abs(off.z()), 5 * stated_mm);
    EXPECT_EQ(d->visible_fraction, 1) << "nothing tells what is hidden";
    EXPECT_EQ(d->depth_support, 0);
  }
}

TEST(IntensityAlone, TellsThatTheDistanceIsLoose) {
  IntensityRig rig;
  const DetectionReport report = rig.detect(without_depth(scene())).value();
  ASSERT_FALSE(report.detections.empty());
  for (const Detection& d : report.detections) {
    const PoseUncertainty& u = d.uncertainty;
    EXPECT_GT(std::abs(u.weak_shift.dot(d.T_cam_obj.t_mm.normalized())), 0.9) << "along the ray";
    const auto deviation = [&](std::size_t axis) { return std::sqrt(u.covariance[7 * axis]); };
    EXPECT_GT(u.weak_shift_mm, 3 * deviation(3));
    EXPECT_GT(u.weak_shift_mm, 3 * deviation(4));
  }
}

TEST(IntensityAlone, FindsNothingWhereNothingIs) {
  IntensityRig rig;
  BracketScene empty = render_brackets(bracket_camera(), {});
  const auto nothing_in = [&](const BracketScene& seen) {
    return rig.detect(without_depth(seen), Modality::kAutomatic, 0.4).value().detections.empty();
  };
  EXPECT_TRUE(nothing_in(empty));
  std::mt19937 random(3);
  for (auto& g : empty.gray) g = static_cast<std::uint8_t>(random());
  EXPECT_TRUE(nothing_in(empty)) << "noise";
  for (std::size_t i = 0; i < empty.gray.size(); ++i)  // a grid of bright squares
    empty.gray[i] = i % 480 / 24 % 2 != i / 480 / 24 % 2 ? 180 : 60;
  EXPECT_TRUE(nothing_in(empty)) << "squares";
}

TEST(IntensityAlone, AnswersTheSameBitsOnAnyNumberOfThreads) {
  IntensityRig one(1), three(3);
  expect_same(one.detect(without_depth(scene())).value(),
              three.detect(without_depth(scene())).value());
}

TEST(IntensityAlone, AllocatesNothing) {
  if (!allocations_counted()) GTEST_SKIP() << "the sanitizer holds malloc";
  IntensityRig rig;
  for (int i = 0; i < 2; ++i) {
    const long long before = allocation_count();
    ASSERT_TRUE(rig.detect(without_depth(scene())).ok());
    EXPECT_EQ(before, allocation_count());
  }
}

TEST(Modality, ChosenIsAsIfTheFrameHadNoOtherImage) {
  IntensityRig a, b;
  expect_same(a.detect(scene().frame(), Modality::kIntensity).value(),
              b.detect(without_depth(scene())).value());
  Frame depth = scene().frame();
  depth.intensity = {};
  expect_same(a.detect(scene().frame(), Modality::kDepth).value(), b.detect(depth).value());
  expect_same(a.detect(scene().frame(), Modality::kDepthAndIntensity).value(),
              b.detect(scene().frame()).value());
}

TEST(Modality, ThatIsMissingIsAnError) {
  IntensityRig rig;
  Frame depth = scene().frame();
  depth.intensity = {};
  const Frame intensity = without_depth(scene());
  EXPECT_EQ(rig.error_of(intensity, Modality::kDepth), ErrorCode::kFrameWithoutDepth);
  EXPECT_EQ(rig.error_of(intensity, Modality::kDepthAndIntensity), ErrorCode::kFrameWithoutDepth);
  EXPECT_EQ(rig.error_of(depth, Modality::kIntensity), ErrorCode::kFrameWithoutIntensity);
  EXPECT_EQ(rig.error_of(depth, Modality::kDepthAndIntensity), ErrorCode::kFrameWithoutIntensity);
  for (int i = 0; i < kModalityCount; ++i)
    EXPECT_EQ(rig.error_of({}, static_cast<Modality>(i)), ErrorCode::kFrameEmpty);
}

// Depth that failed does not silently become poses whose distance is loose.
TEST(Modality, AutomaticDoesNotFallBackToIntensity) {
  IntensityRig rig;
  const std::vector<float> nothing(scene().depth_mm.size(), 0.0f);
  Frame frame = scene().frame();
  frame.depth_mm.data = nothing.data();
  for (const Modality m : {Modality::kAutomatic, Modality::kDepth, Modality::kDepthAndIntensity})
    EXPECT_TRUE(rig.detect(frame, m).value().detections.empty());
  EXPECT_FALSE(rig.detect(frame, Modality::kIntensity).value().detections.empty());
}

}  // namespace
}  // namespace binpick
