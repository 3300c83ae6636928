#include <gtest/gtest.h>

#include <cstring>

#include "binpick/drivers/bop_dataset.hpp"
#include "binpick/drivers/open_camera.hpp"

namespace binpick::drivers {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
const std::string kBin = BINPICK_TEST_DATA "/bin-sample";

struct Replay {
  explicit Replay(TriggerSource trigger, bool paced = false, bool loop = false, int slots = 2,
                  int width = 1280)
      : arena(FramePool::footprint({slots, width, 1024})), pool({slots, width, 1024}, arena) {
    CameraSpec spec;
    spec.uri = "replay:" + kBin;
    spec.trigger = trigger;
    spec.paced = paced;
    spec.loop = loop;
    if (paced) spec.frame_rate_hz = 20;
    camera = open_camera(spec);
    camera->start(pool);
  }
  Result<FrameRef> wait(std::chrono::milliseconds within = 5000ms) {
    return camera->wait_frame(Clock::now() + within);
  }
  Arena arena;
  FramePool pool;
  std::unique_ptr<Camera> camera;
};

TEST(ReplayCamera, GivesEachFrameOnceWithTheBitsOfItsFile) {
  Replay r(TriggerSource::kFreeRun);
  const BopDataset data(kBin, "test");
  std::uint64_t sequence = 0;
  for (const int scene_id : data.scene_ids()) {
    const BopScene scene = data.scene(scene_id);
    for (const auto& [im_id, camera] : scene.frames) {
      const LoadedFrame file = data.load_frame(scene, im_id);
      const Result<FrameRef> result = r.wait();
      ASSERT_TRUE(result.ok());
      const Frame& frame = result.value().frame();
      EXPECT_EQ(frame.sequence, ++sequence);
      EXPECT_EQ(frame.camera.fy, file.camera.fy);
      EXPECT_EQ(frame.roi.width, file.roi.width);
      EXPECT_EQ(std::memcmp(frame.depth_mm.data, file.depth_mm.data(), file.depth_mm.size() * 4),
                0);
      EXPECT_EQ(std::memcmp(frame.intensity.data, file.intensity.data(), file.intensity.size()), 0);
    }
  }
  EXPECT_EQ(r.wait().error().code, ErrorCode::kSensorEnd);
  EXPECT_EQ(r.camera->counters().frames, sequence);
}

TEST(ReplayCamera, WaitsForTheTriggerAndLoops) {
  Replay r(TriggerSource::kSoftware, false, true);
  EXPECT_EQ(r.wait(20ms).error().code, ErrorCode::kSensorTimeout);
  for (std::uint64_t i = 1; i <= 10; ++i) {  // the bin has seven frames
    ASSERT_EQ(r.camera->trigger().code, ErrorCode::kNone);
    const Result<FrameRef> frame = r.wait();
    ASSERT_TRUE(frame.ok());
    EXPECT_EQ(frame.value().frame().sequence, i);
  }
}

TEST(ReplayCamera, PacesFrames) {
  Replay r(TriggerSource::kFreeRun, true);
  const auto begun = Clock::now();
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(r.wait().ok());
  EXPECT_GE(Clock::now() - begun, 190ms);
}

TEST(ReplayCamera, DropsWhatThePoolCannotHold) {
  Replay small(TriggerSource::kFreeRun, false, false, 2, 640);
  const Error error = small.wait().error();
  EXPECT_EQ(error.code, ErrorCode::kFrameTooLarge);
  EXPECT_EQ(error.detail, frame_too_large(1280, 1024).detail) << "the frame's size";
  EXPECT_EQ(small.camera->counters().dropped_count(DropReason::kSize), 1u);
  Replay one(TriggerSource::kFreeRun, false, false, 1);
  const Result<FrameRef> held = one.wait();
  ASSERT_TRUE(held.ok());
  EXPECT_EQ(one.wait().error().detail, static_cast<int>(DropReason::kPoolEmpty));
  EXPECT_EQ(one.camera->counters().dropped_total(), 1u);
}

TEST(ReplayCamera, StartsAndStopsAndStartsAgain) {
  Replay r(TriggerSource::kFreeRun, false, true);
  for (int i = 0; i < 10; ++i) {
    const Result<FrameRef> frame = r.wait();
    ASSERT_TRUE(frame.ok());
    EXPECT_EQ(frame.value().frame().sequence, 1u);
    r.camera->stop();
    EXPECT_EQ(r.wait().error().code, ErrorCode::kSensorNotStarted);
    r.camera->start(r.pool);
  }
}

TEST(ReplayCamera, AMissingFolderIsNamed) {
  CameraSpec spec;
  spec.uri = "replay:/no/such/folder";
  EXPECT_THROW(open_camera(spec), DatasetError);
}

}  // namespace
}  // namespace binpick::drivers
