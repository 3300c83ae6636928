// The detector on rendered scenes of a small part: what it finds, refuses and promises.
#include "binpick/detect/detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "allocation_count.hpp"
#include "detector_rig.hpp"

namespace binpick {
namespace {

constexpr DetectorLimits kLimits = DetectorRig::kLimits;

std::int64_t steady_ns() {
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

struct Rig : DetectorRig {
  using DetectorRig::DetectorRig;

  Result<DetectionReport> detect(const Frame& frame) {
    DetectRequest request;
    request.min_score = 0.4;
    return detector.detect(frame, request);
  }
  ErrorCode error_of(const Frame& frame) {
    const Result<DetectionReport> report = detect(frame);
    return report.ok() ? ErrorCode::kNone : report.error().code;
  }
};

const BracketScene& scene() {
  static const BracketScene once = render_brackets(bracket_camera(), three_brackets(), 0.1);
  return once;
}

// Every part found once, nothing else.
void expect_all_found(const DetectionReport& report, const std::vector<Pose>& truth,
                      double angle_limit_deg, double shift_limit_mm) {
  EXPECT_EQ(truth.size(), report.detections.size());
  for (const Pose& T : truth) {
    double angle_deg = 180, shift_mm = 1e9;
    for (const Detection& d : report.detections) {
      const PoseError e = pose_error(d.T_cam_obj, T);
      if (e.shift_mm < shift_mm) {
        angle_deg = e.angle_deg;
        shift_mm = e.shift_mm;
      }
    }
    std::printf("[ measured ] %.2f deg %.2f mm\n", angle_deg, shift_mm);
    EXPECT_LE(angle_deg, angle_limit_deg);
    EXPECT_LE(shift_mm, shift_limit_mm);
  }
}

// What two runs must agree on: everything but the times.
void expect_same_bits(const DetectionReport& a, const DetectionReport& b, const char* what) {
  ASSERT_EQ(a.detections.size(), b.detections.size()) << what;
  for (std::size_t i = 0; i < a.detections.size(); ++i) {
    const Detection &x = a.detections[i], &y = b.detections[i];
    EXPECT_EQ(x.T_cam_obj.R, y.T_cam_obj.R) << what;
    EXPECT_EQ(x.T_cam_obj.t_mm, y.T_cam_obj.t_mm) << what;
    EXPECT_EQ(x.model_index, y.model_index) << what;
    EXPECT_EQ(x.score, y.score) << what;
    EXPECT_EQ(x.visible_fraction, y.visible_fraction) << what;
    EXPECT_EQ(x.depth_support, y.depth_support) << what;
    EXPECT_EQ(x.contour_support, y.contour_support) << what;
    EXPECT_EQ(x.depth_residual_mm, y.depth_residual_mm) << what;
    EXPECT_EQ(x.template_score, y.template_score) << what;
    EXPECT_EQ(x.template_index, y.template_index) << what;
  }
  EXPECT_EQ(a.level_count, b.level_count) << what;
  EXPECT_EQ(a.candidates, b.candidates) << what;
  EXPECT_EQ(a.templates_evaluated, b.templates_evaluated) << what;
  EXPECT_EQ(a.dropped, b.dropped) << what;
}

// A report that outlives its detector.
struct KeptReport {
  explicit KeptReport(const DetectionReport& r)
      : detections(r.detections.begin(), r.detections.end()), report(r) {
    report.detections = detections;
  }
  KeptReport(const KeptReport&) = delete;
  std::vector<Detection> detections;
  DetectionReport report;
};

const DetectionReport& reference_report() {
  static const KeptReport once = [] {
    Rig rig;
    return KeptReport(rig.detect(scene().frame()).value());
  }();
  return once.report;
}

TEST(Detector, FindsEveryPartOnAPlane) {
  expect_all_found(reference_report(), scene().truth, 2, 1);
}

TEST(Detector, ReportsItsEvidence) {
  double last = 1;
  for (const Detection& d : reference_report().detections) {
    EXPECT_LE(d.score, last) << "best first";
    last = d.score;
    EXPECT_GE(d.score, 0.4);
    EXPECT_GT(d.visible_fraction, 0.8);
    EXPECT_GT(d.depth_support, 0.6);
    EXPECT_GT(d.contour_support, 0.6);
    EXPECT_LT(d.depth_residual_mm, 0.5);
    EXPECT_GT(d.template_score, 0.9);
    EXPECT_GE(d.template_index, 0);
  }
  EXPECT_EQ(bracket_model().depth_count(), reference_report().level_count);
}

TEST(Detector, AnswersTheSameBitsOnAnyNumberOfThreads) {
  for (const int threads : {2, 4}) {
    Rig rig(kLimits, {}, threads);
    const std::string what = std::to_string(threads) + " threads";
    expect_same_bits(reference_report(), rig.detect(scene().frame()).value(), what.c_str());
  }
}

TEST(Detector, AnswersTheSameBitsOnEveryVectorUnit) {
  for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (!isa_supported(isa)) continue;
    Rig rig(kLimits, {MapLayout::kRearranged, isa});
    expect_same_bits(reference_report(), rig.detect(scene().frame()).value(), isa_name(isa));
  }
}

TEST(Detector, AnswersTheSameBitsInThePlainLayout) {
  Rig rig(kLimits, {MapLayout::kPlain, Isa::kBest});
  expect_same_bits(reference_report(), rig.detect(scene().frame()).value(), "plain");
}

TEST(Detector, AnswersTheSameBitsAgain) {
  Rig rig;
  const BracketScene other = render_brackets(bracket_camera(), {three_brackets()[1]});
  ASSERT_TRUE(rig.detect(scene().frame()).ok());
  ASSERT_TRUE(rig.detect(other.frame()).ok());  // leaves nothing behind
  expect_same_bits(reference_report(), rig.detect(scene().frame()).value(), "third run");
}

TEST(Detector, TakesExactlyItsFootprint) {
  for (const int threads : {1, 3}) {
    for (const DetectorLimits& limits : {kLimits, DetectorLimits{1280, 1024, 500, 300, 5}}) {
      Rig rig(limits, {}, threads);
      EXPECT_EQ(rig.arena.size_bytes(), rig.arena.used_bytes());
    }
  }
}

TEST(Detector, AllocatesNothing) {
  if (!allocations_counted()) GTEST_SKIP() << "the sanitizer holds malloc";
  Rig rig;
  const Frame frame = scene().frame();
  const long long before_check = allocation_count();
  int* volatile number = new int(1);  // volatile: not to be optimized away
  delete number;
  ASSERT_GT(allocation_count(), before_check) << "the counter does not count";
  for (int i = 0; i < 2; ++i) {  // from the first frame on
    const long long before = allocation_count();
    const Result<DetectionReport> report = rig.detect(frame);
    EXPECT_EQ(before, allocation_count());
    ASSERT_TRUE(report.ok());
  }
}

TEST(Detector, KeepsToTheLimitOfResults) {
  Rig rig;
  DetectRequest request;
  request.max_results = 1;
  const DetectionReport one = rig.detector.detect(scene().frame(), request).value();
  EXPECT_EQ(1u, one.detections.size());
  EXPECT_GT(one.dropped[static_cast<int>(DropReason::kResultLimit)], 0);
  request.max_results = -1;
  EXPECT_TRUE(rig.detector.detect(scene().frame(), request).value().detections.empty());
  request.max_results = 1000000;
  EXPECT_EQ(3u, rig.detector.detect(scene().frame(), request).value().detections.size());
}

TEST(Detector, KeepsToTheRegionOfInterest) {
  Rig rig;
  Frame frame = scene().frame();
  frame.roi = {20, 40, 200, 160};  // about the first part
  const DetectionReport report = rig.detect(frame).value();
  ASSERT_EQ(1u, report.detections.size());
  EXPECT_TRUE(pose_error(report.detections[0].T_cam_obj, scene().truth[0]).within(2, 1));
}

TEST(Detector, WorksInARegionWithoutTheWholeImage) {
  Rig rig({480, 360, 210, 170, 8});
  Frame frame = scene().frame();
  frame.roi = {20, 40, 200, 160};
  ASSERT_EQ(1u, rig.detect(frame).value().detections.size());
  frame.roi = {};
  EXPECT_EQ(ErrorCode::kRoiTooLarge, rig.error_of(frame));
}

TEST(Detector, CutsARegionThatReachesOut) {
  Rig rig;
  Frame frame = scene().frame();
  frame.roi = {-1000, -1000, 100000, 100000};
  EXPECT_EQ(3u, rig.detect(frame).value().detections.size());
  constexpr int kMax = std::numeric_limits<int>::max();
  frame.roi = {260, 0, kMax, kMax};  // about the second part
  EXPECT_EQ(1u, rig.detect(frame).value().detections.size());
}

TEST(Detector, RefusesARegionOutside) {
  Rig rig;
  Frame frame = scene().frame();
  constexpr int kMin = std::numeric_limits<int>::min();
  for (const Roi& roi : {Roi{480, 0, 50, 50}, Roi{0, 360, 50, 50}, Roi{-60, 10, 50, 50},
                         Roi{2000000000, 0, 2000000000, 10}, Roi{kMin, kMin, 10, 10}}) {
    frame.roi = roi;
    EXPECT_EQ(ErrorCode::kRoiOutsideImage, rig.error_of(frame)) << roi.x << ' ' << roi.y;
  }
}

TEST(Detector, RefusesFramesThatAreNone) {
  Rig rig;
  Frame frame = scene().frame();
  frame.depth_mm = {};
  frame.intensity = {};
  EXPECT_EQ(ErrorCode::kFrameEmpty, rig.error_of(frame));
  frame = scene().frame();
  frame.intensity.width -= 1;
  EXPECT_EQ(ErrorCode::kFrameSizeMismatch, rig.error_of(frame));
  frame = scene().frame();
  frame.depth_mm = frame.depth_mm.crop(0, 0, 480, 300);
  EXPECT_EQ(ErrorCode::kFrameSizeMismatch, rig.error_of(frame));
  Rig small({320, 240, 0, 0, 8});
  EXPECT_EQ(ErrorCode::kFrameTooLarge, small.error_of(scene().frame()));
}

TEST(Detector, FindsNothingInAFrameOfAFewPixels) {
  Rig rig;
  for (const int size : {1, 2, 5, 17}) {
    Frame frame = scene().frame();
    frame.depth_mm = frame.depth_mm.crop(240, 180, size, size);
    frame.intensity = frame.intensity.crop(240, 180, size, size);
    const Result<DetectionReport> report = rig.detect(frame);
    EXPECT_TRUE(!report.ok() || report.value().detections.empty()) << size;
  }
}

TEST(Detector, RefusesIntrinsicsThatAreNone) {
  Rig rig;
  for (const double bad : {0.0, -800.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    Frame frame = scene().frame();
    frame.camera.fx = bad;
    EXPECT_EQ(ErrorCode::kIntrinsicsInvalid, rig.error_of(frame)) << bad;
  }
}

TEST(Detector, RefusesAnUnknownModel) {
  Rig rig;
  for (const int index : {-1, 1, 1000}) {
    DetectRequest request;
    request.model_indices = {&index, 1};
    const Result<DetectionReport> report = rig.detector.detect(scene().frame(), request);
    ASSERT_FALSE(report.ok());
    EXPECT_EQ(ErrorCode::kModelIndexUnknown, report.error().code);
  }
}

TEST(Detector, FindsNothingWhereNothingWasMeasured) {
  Rig rig;
  const float inf = std::numeric_limits<float>::infinity();
  for (const float value : {0.0f, -5.0f, std::numeric_limits<float>::quiet_NaN(), inf, -inf, 1e30f,
                            std::numeric_limits<float>::denorm_min()}) {
    const std::vector<float> depth(scene().depth_mm.size(), value);
    Frame frame = scene().frame();
    frame.depth_mm.data = depth.data();
    const Result<DetectionReport> report = rig.detect(frame);
    ASSERT_TRUE(report.ok()) << value;
    EXPECT_TRUE(report.value().detections.empty()) << value;
  }
}

TEST(Detector, FindsNothingInNoise) {
  Rig rig;
  std::mt19937 random(3);
  BracketScene noise = scene();
  for (auto& g : noise.gray) g = static_cast<std::uint8_t>(random());
  for (auto& z : noise.depth_mm) {
    const std::uint32_t bits = static_cast<std::uint32_t>(random());  // any float there is
    std::memcpy(&z, &bits, sizeof(z));
  }
  EXPECT_TRUE(rig.detect(noise.frame()).value().detections.empty());
  for (auto& z : noise.depth_mm) z = 400 + static_cast<float>(random() % 2000) * 0.1f;
  EXPECT_TRUE(rig.detect(noise.frame()).value().detections.empty());
}

TEST(Detector, HoldsWithScatteredMissingDepth) {
  Rig rig;
  std::mt19937 random(4);
  BracketScene holes = scene();
  for (auto& z : holes.depth_mm) {
    if (random() % 10 == 0) z = std::numeric_limits<float>::quiet_NaN();
  }
  expect_all_found(rig.detect(holes.frame()).value(), holes.truth, 2, 1);
}

// Of intensity alone: intensity_alone_test.
TEST(Detector, FindsEveryPartByDepthAlone) {
  Rig rig;
  Frame frame = scene().frame();
  frame.intensity = {};
  expect_all_found(rig.detect(frame).value(), scene().truth, 2, 1);
}

// The same scene through another lens.
CameraIntrinsics other_camera(double focal_factor, double image_factor) {
  CameraIntrinsics c = bracket_camera();
  c.width = static_cast<int>(c.width * image_factor);
  c.height = static_cast<int>(c.height * image_factor);
  c.fx *= focal_factor;
  c.fy *= focal_factor;
  c.cx = (c.width - 1) / 2.0;
  c.cy = (c.height - 1) / 2.0;
  return c;
}

TEST(Detector, BridgesAnotherCamera) {
  for (const auto& [focal, image] :
       {std::pair(1.5, 1.5), std::pair(2.0, 2.0), std::pair(0.7, 1.0)}) {
    const BracketScene seen = render_brackets(other_camera(focal, image), three_brackets(), 0.1);
    Rig rig({seen.camera.width, seen.camera.height, 0, 0, 32});
    const Result<DetectionReport> report = rig.detect(seen.frame());
    ASSERT_TRUE(report.ok()) << focal << ": " << error_message(report.error().code);
    SCOPED_TRACE("focal length x " + std::to_string(focal));
    expect_all_found(report.value(), seen.truth, 2, 1);
  }
}

TEST(Detector, RefusesACameraThatIsTooFarOff) {
  Rig rig;
  for (const double factor : {20.0, 0.02, 1e200, 1e-200}) {
    Frame frame = scene().frame();
    frame.camera.fx *= factor;
    frame.camera.fy *= factor;
    EXPECT_EQ(ErrorCode::kModelCameraMismatch, rig.error_of(frame)) << factor;
  }
}

TEST(Detector, SurvivesAnAbsurdPrincipalPoint) {
  Rig rig;
  for (const double centre : {1e9, -1e300, 1e300}) {
    Frame frame = scene().frame();
    frame.camera.cx = centre;
    frame.camera.cy = -centre;
    const Result<DetectionReport> report = rig.detect(frame);
    EXPECT_TRUE(!report.ok() || report.value().detections.empty()) << centre;
  }
}

TEST(Detector, TimesItsStagesByTheGivenClock) {
  Rig rig(kLimits, {}, 1, steady_ns);
  const DetectionReport report = rig.detect(scene().frame()).value();
  double sum = 0;
  for (const double ms : report.stage_ms) {
    EXPECT_GE(ms, 0);
    sum += ms;
  }
  EXPECT_GT(sum, 0);
  EXPECT_LE(sum, report.total_ms * 1.001 + 0.1);
  EXPECT_EQ(0, reference_report().total_ms);
}

}  // namespace
}  // namespace binpick
