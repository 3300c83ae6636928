// The recorder as the station uses it: what is written when, and that it comes back bit for bit.
#include "recorder/cycle_recorder.hpp"

#include <gmock/gmock.h>
#include <pthread.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "binpick/drivers/bop_dataset.hpp"
#include "core/allocation_count.hpp"
#include "operation/recorded_frame.hpp"
#include "temporary_folder.hpp"

namespace fs = std::filesystem;

namespace binpick::app {
namespace {

using nlohmann::json;
using testing::ElementsAre;

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::vector<std::uint64_t> cycles_of(const std::string& recording) {
  std::vector<std::uint64_t> cycles;
  for (const std::string& line : lines_of(recording))
    cycles.push_back(json::parse(line).at("cycle").get<std::uint64_t>());
  return cycles;
}

TEST(CycleRecorder, WhatIsWrittenIsADataSetWithTheSameBits) {
  const TemporaryFolder folder;
  const double scale_mm = 0.123;
  {
    TestRecorder t(test_params(folder.path(), RecordMode::kAlways));
    for (const std::uint64_t cycle : {11, 12}) {
      const TestFrame frame(96, 64, cycle, scale_mm);
      t.recorder.record(TestCycle(cycle, &frame.frame).record);
    }
    t.recorder.record(TestCycle(13, nullptr, true).record);
    ASSERT_TRUE(holds_in_time([&] { return t.recorder.counters().written == 3; }));
  }
  ASSERT_EQ(recordings_in(folder.path()).size(), 1u);
  const std::string recording = recordings_in(folder.path()).front();
  EXPECT_THAT(fs::path(recording).filename(), "000001-20260101T000000Z");

  const drivers::BopDataset data(recording, "test");
  const drivers::BopScene scene = data.scene(1);
  ASSERT_EQ(scene.frames.size(), 2u);
  for (const int image : {0, 1}) {
    const drivers::LoadedFrame loaded = data.load_frame(scene, image);
    const TestFrame frame(96, 64, 11 + static_cast<std::uint64_t>(image), scale_mm);
    EXPECT_EQ(loaded.depth_mm, frame.depth_mm);
    EXPECT_EQ(loaded.intensity, frame.intensity);
    EXPECT_EQ(loaded.depth_scale_mm, scale_mm);
    EXPECT_EQ(loaded.camera.fx, 1000.1);
    EXPECT_EQ(loaded.camera.cy, frame.frame.camera.cy);
    EXPECT_EQ(loaded.roi.width, 48);
  }

  EXPECT_THAT(cycles_of(recording), ElementsAre(11, 12, 13));
  const json last = json::parse(lines_of(recording).back());
  EXPECT_FALSE(last.contains("image"));
  EXPECT_EQ(last.at("cause_name"), "sensor_lost");
  EXPECT_EQ(last.at("command").get<std::vector<std::uint16_t>>(), TestCycle(13).command);
  EXPECT_EQ(last.at("answer").get<std::vector<std::uint16_t>>(), TestCycle(13).answer);
  EXPECT_EQ(last.at("times_ms").at("detect"), 100.25);
  EXPECT_EQ(json::parse(lines_of(recording)[1]).at("image"), 1);

  const json head = json::parse(text_of(recording + "/recording.json"));
  EXPECT_EQ(head.at("program"), "test \"1\"");
  EXPECT_EQ(head.at("models").at(0).at("hash"), "0123456789abcdef");
  EXPECT_EQ(text_of(recording + "/configuration/binpick.toml"), "a = 1\n");
  EXPECT_EQ(text_of(recording + "/configuration/recipes/part.toml"), "number = 1\n");
}

TEST(CycleRecorder, AFaultWritesWhatLedToIt) {
  const TemporaryFolder folder;
  {
    TestRecorder t(test_params(folder.path(), RecordMode::kOnFault));
    for (std::uint64_t cycle = 1; cycle <= 6; ++cycle)
      t.recorder.record(TestCycle(cycle, nullptr, cycle == 6).record);
    ASSERT_TRUE(holds_in_time([&] { return t.recorder.counters().written == 4; }));
    EXPECT_EQ(t.recorder.counters().recorded, 6u);
    EXPECT_EQ(t.recorder.counters().overwritten, 0u) << "none of them was to be written";
  }
  EXPECT_THAT(cycles_of(recordings_in(folder.path()).at(0)), ElementsAre(3, 4, 5, 6));
}

TEST(CycleRecorder, OnCommandFaultsAreKeptInMemoryOnly) {
  const TemporaryFolder folder;
  {
    TestRecorder t(test_params(folder.path(), RecordMode::kOnCommand));
    t.recorder.record(TestCycle(1, nullptr, true).record);
    t.recorder.record(TestCycle(2).record);
    EXPECT_TRUE(recordings_in(folder.path()).empty());
    t.recorder.write_kept();
    ASSERT_TRUE(holds_in_time([&] { return t.recorder.counters().written == 2; }));
    t.recorder.record(TestCycle(3).record);
  }
  EXPECT_THAT(cycles_of(recordings_in(folder.path()).at(0)), ElementsAre(1, 2));
}

TEST(CycleRecorder, AnotherConfigurationIsAnotherRecording) {
  const TemporaryFolder folder;
  {
    TestRecorder t(test_params(folder.path(), RecordMode::kAlways));
    t.recorder.record(TestCycle(1).record);
    t.recorder.set_configuration(test_configuration("a = 2\n"));
    t.recorder.record(TestCycle(2).record);
    ASSERT_TRUE(holds_in_time([&] { return t.recorder.counters().written == 2; }));
  }
  const auto recordings = recordings_in(folder.path());
  ASSERT_EQ(recordings.size(), 2u);
  EXPECT_EQ(text_of(recordings[0] + "/configuration/binpick.toml"), "a = 1\n");
  EXPECT_EQ(text_of(recordings[1] + "/configuration/binpick.toml"), "a = 2\n");
  EXPECT_THAT(cycles_of(recordings[1]), ElementsAre(2));
}

// Each data set has the folders of what its frames have, and an order without a frame fits any.
TEST(CycleRecorder, FramesOfAnotherKindAreAnotherRecording) {
  const TemporaryFolder folder;
  {
    TestRecorder t(test_params(folder.path(), RecordMode::kAlways));
    std::uint64_t recorded = 0;
    const auto record = [&](const Frame* frame) {
      t.recorder.record(TestCycle(++recorded, frame).record);
      ASSERT_TRUE(holds_in_time([&] { return t.recorder.counters().written == recorded; }));
    };
    const auto record_frame = [&](bool with_depth, bool with_intensity) {
      TestFrame kept(96, 64, recorded + 1);
      if (!with_depth) kept.frame.depth_mm = {};
      if (!with_intensity) kept.frame.intensity = {};
      record(&kept.frame);
    };
    record_frame(false, true);
    record(nullptr);
    record_frame(false, true);
    record_frame(true, true);
    record_frame(true, false);
    EXPECT_EQ(t.recorder.counters().frame_too_large, 0u);
  }
  const auto recordings = recordings_in(folder.path());
  ASSERT_EQ(recordings.size(), 3u);
  EXPECT_THAT(cycles_of(recordings[0]), ElementsAre(1, 2, 3));
  EXPECT_THAT(cycles_of(recordings[1]), ElementsAre(4));
  EXPECT_THAT(cycles_of(recordings[2]), ElementsAre(5));
  const auto loaded = [&](std::size_t recording, int image) {
    const drivers::BopDataset data(recordings[recording], "test");
    return data.load_frame(data.scene(1), image);
  };
  EXPECT_TRUE(loaded(0, 1).depth_mm.empty());
  EXPECT_EQ(loaded(0, 1).intensity, TestFrame(96, 64, 3).intensity);
  EXPECT_EQ(loaded(1, 0).depth_mm, TestFrame(96, 64, 4).depth_mm);
  EXPECT_EQ(loaded(1, 0).intensity, TestFrame(96, 64, 4).intensity);
  EXPECT_EQ(loaded(2, 0).depth_mm, TestFrame(96, 64, 5).depth_mm);
  EXPECT_TRUE(loaded(2, 0).intensity.empty());
}

TEST(CycleRecorder, RestartContinuesTheNumbersAndFullRecordingsEnd) {
  const TemporaryFolder folder;
  std::uint64_t cycle = 0;
  for (int run = 0; run < 2; ++run) {
    TestRecorder t(test_params(folder.path(), RecordMode::kAlways));
    for (int i = 0; i < RecordingWriter::kFramesMax + 1; ++i) {
      t.recorder.record(TestCycle(++cycle).record);
      ASSERT_TRUE(holds_in_time(
          [&] { return t.recorder.counters().written == static_cast<std::uint64_t>(i) + 1; }));
    }
  }
  const auto recordings = recordings_in(folder.path());
  ASSERT_EQ(recordings.size(), 4u);
  EXPECT_EQ(fs::path(recordings[3]).filename().string().substr(0, 7), "000004-");
  EXPECT_THAT(cycles_of(recordings[3]), ElementsAre(cycle));
}

TEST(CycleRecorder, NothingIsTakenFromTheHeapOnceItRuns) {
  if (!allocations_counted()) GTEST_SKIP() << "SKIPPED: a sanitizer holds malloc";
  const TemporaryFolder folder;
  CycleRecorderParams params = test_params(folder.path(), RecordMode::kAlways);
  params.shelf.bytes_max = 512 << 10;  // recordings are removed too
  TestRecorder t(params);
  const TestFrame frame(96, 64, 1);
  const TestCycle cycle(1, &frame.frame);
  const auto handled = [&] {
    const RecorderCounters c = t.recorder.counters();
    return c.written + c.write_failed + c.overwritten;
  };
  const auto run = [&](int cycles) {
    for (int i = 0; i < cycles; ++i) {
      t.recorder.record(cycle.record);
      // Not holds_in_time(): its std::function may take from the heap.
      const timespec pause{0, 200'000};
      for (int wait = 0; handled() < t.recorder.counters().recorded && wait < 100'000; ++wait)
        nanosleep(&pause, nullptr);
    }
  };
  run(2);
  const long long before = allocation_count();
  run(200);
  EXPECT_EQ(allocation_count(), before);
  EXPECT_GT(t.recorder.counters().recordings_removed, 0u);
  EXPECT_EQ(t.recorder.counters().write_failed, 0u);
}

std::size_t open_files() {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator()));
}
std::size_t threads() {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator("/proc/self/task"), fs::directory_iterator()));
}

TEST(CycleRecorder, AHundredStartsAndStopsLeaveNothingBehind) {
  const TemporaryFolder folder;
  const std::size_t files = open_files(), tasks = threads();
  const TestFrame frame(96, 64, 1);
  for (std::uint64_t run = 0; run < 100; ++run) {
    CycleRecorderParams params = test_params(folder.path(), RecordMode::kAlways);
    params.shelf.bytes_max = 1 << 20;
    TestRecorder t(params);
    t.recorder.record(TestCycle(run + 1, &frame.frame).record);
  }
  EXPECT_EQ(open_files(), files);
  EXPECT_EQ(threads(), tasks);
  // What was recorded last is written at the end of each run.
  EXPECT_THAT(cycles_of(recordings_in(folder.path()).back()), ElementsAre(100));
}

}  // namespace
}  // namespace binpick::app
