// A deadline cuts a detection short: what is verified by then is answered, nothing half-done.
#include <gtest/gtest.h>

#include <vector>

#include "binpick/detect/detector.hpp"
#include "detector_rig.hpp"

namespace binpick {
namespace {

// A clock on which time passes by being asked: the same on every machine.
std::int64_t asked_ns = 0;
std::int64_t asked_clock() {
  return asked_ns += 1000;
}

struct DeadlineRig : DetectorRig {
  explicit DeadlineRig(ClockFn clock) : DetectorRig(kLimits, {}, 1, clock) {}

  // Of a deadline so many readings of the clock after the start; 0: none.
  DetectionReport detect(const Frame& frame, std::int64_t readings) {
    DetectRequest request;
    request.min_score = 0.4;
    request.deadline_ns = readings == 0 ? 0 : asked_ns + 1000 * readings;
    return detector.detect(frame, request).value();
  }
};

const BracketScene& scene() {
  static const BracketScene once = render_brackets(bracket_camera(), three_brackets(), 0.1);
  return once;
}

struct Answer {
  std::vector<Detection> detections;
  bool cut_short;
  int dropped;
};

Answer answer(const DetectionReport& report) {
  return {{report.detections.begin(), report.detections.end()},
          report.cut_short,
          report.dropped[static_cast<std::size_t>(DropReason::kDeadline)]};
}

TEST(DetectorDeadline, ThatIsFarOffChangesNothing) {
  DeadlineRig rig(asked_clock);
  const Answer free = answer(rig.detect(scene().frame(), 0));
  const Answer timed = answer(rig.detect(scene().frame(), 10'000'000));
  EXPECT_FALSE(free.cut_short);
  EXPECT_FALSE(timed.cut_short);
  ASSERT_EQ(3u, free.detections.size());
  ASSERT_EQ(3u, timed.detections.size());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(free.detections[i].T_cam_obj.t_mm, timed.detections[i].T_cam_obj.t_mm);
    EXPECT_EQ(free.detections[i].score, timed.detections[i].score);
  }
}

TEST(DetectorDeadline, ThatHasPassedGivesNothing) {
  DeadlineRig rig(asked_clock);
  const Answer a = answer(rig.detect(scene().frame(), 1));
  EXPECT_TRUE(a.cut_short);
  EXPECT_TRUE(a.detections.empty());
}

// The sooner the deadline, the fewer hypotheses are worked on; what is answered is right all the
// same.
TEST(DetectorDeadline, CutsTheLeastPromisingFirst) {
  DeadlineRig rig(asked_clock);
  int with_some = 0, cut = 0;
  for (std::int64_t readings = 50; readings <= 12'800; readings *= 2) {
    const Answer a = answer(rig.detect(scene().frame(), readings));
    std::printf("[ measured ] deadline after %lld readings: %zu found, %d dropped%s\n",
                static_cast<long long>(readings), a.detections.size(), a.dropped,
                a.cut_short ? ", cut short" : "");
    EXPECT_EQ(a.dropped > 0 || (a.cut_short && a.detections.empty()), a.cut_short);
    cut += a.cut_short;
    with_some += a.cut_short && !a.detections.empty();
    for (const Detection& d : a.detections) {
      double nearest_mm = 1e9;
      for (const Pose& T : scene().truth)
        nearest_mm = std::min(nearest_mm, (T.t_mm - d.T_cam_obj.t_mm).norm());
      EXPECT_LT(nearest_mm, 2);
    }
  }
  EXPECT_GE(cut, 3);
  EXPECT_GE(with_some, 1);
}

TEST(DetectorDeadline, MeansNothingWithoutAClock) {
  DeadlineRig rig(nullptr);
  const Answer a = answer(rig.detect(scene().frame(), 1));
  EXPECT_FALSE(a.cut_short);
  EXPECT_EQ(3u, a.detections.size());
}

}  // namespace
}  // namespace binpick
