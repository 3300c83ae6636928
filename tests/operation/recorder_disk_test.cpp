// Disks that are full, slow, or fail: cycles are not touched, losses are counted, and what is on
// the disk stays whole.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "binpick/drivers/bop_dataset.hpp"
#include "operation/recorded_frame.hpp"
#include "setup_error.hpp"
#include "temporary_folder.hpp"

namespace fs = std::filesystem;

namespace binpick::app {
namespace {

std::uint64_t handled(const CycleRecorder& recorder) {
  const RecorderCounters c = recorder.counters();
  return c.written + c.write_failed + c.overwritten;
}

void record_one_by_one(CycleRecorder& recorder, std::uint64_t first, std::uint64_t last,
                       const Frame* frame) {
  for (std::uint64_t cycle = first; cycle <= last; ++cycle) {
    const std::uint64_t before = handled(recorder);
    recorder.record(TestCycle(cycle, frame).record);
    ASSERT_TRUE(holds_in_time([&] { return handled(recorder) > before; }));
  }
}

// Every frame that the data set lists can be read, and every line's frame is listed.
void expect_whole(const std::string& folder) {
  for (const std::string& recording : recordings_in(folder)) {
    if (!fs::exists(recording + "/test/000001/scene_camera.json")) continue;
    const drivers::BopDataset data(recording, "test");
    const drivers::BopScene scene = data.scene(1);
    for (const auto& [image, camera] : scene.frames)
      EXPECT_NO_THROW((void)data.load_frame(scene, image)) << recording;
    for (const auto& entry : fs::recursive_directory_iterator(recording))
      EXPECT_NE(entry.path().extension(), ".new") << entry.path();
    EXPECT_LE(lines_of(recording).size(), scene.frames.size()) << recording;
  }
}

TEST(RecorderDisk, SpaceIsBoundedAndTheOldestGoesFirst) {
  const TemporaryFolder folder;
  CycleRecorderParams params = test_params(folder.path(), RecordMode::kAlways);
  params.shelf.bytes_max = 800 << 10;
  const TestFrame frame(96, 64, 1);
  {
    TestRecorder t(params);
    record_one_by_one(t.recorder, 1, 120, &frame.frame);
    const RecorderCounters c = t.recorder.counters();
    EXPECT_EQ(c.written, 120u);
    EXPECT_GT(c.recordings_removed, 0u);
    EXPECT_LE(c.disk_bytes, params.shelf.bytes_max);
  }
  const auto recordings = recordings_in(folder.path());
  EXPECT_GE(recordings.size(), 2u);
  EXPECT_GT(fs::path(recordings.front()).filename().string(), "000002");
  expect_whole(folder.path());
  // What somebody else put there is left alone, and a smaller bound is reached at once.
  std::ofstream(folder.file("recordings/notes.txt")) << "mine\n";
  params.shelf.bytes_max = 300 << 10;
  {
    TestRecorder t(params);
    record_one_by_one(t.recorder, 121, 121, &frame.frame);
    EXPECT_LE(t.recorder.counters().disk_bytes, params.shelf.bytes_max);
    EXPECT_EQ(t.recorder.counters().written, 1u);
  }
  EXPECT_TRUE(fs::exists(folder.file("recordings/notes.txt")));
}

TEST(RecorderDisk, OthersKeepTheirSpace) {
  const TemporaryFolder folder;
  CycleRecorderParams params = test_params(folder.path(), RecordMode::kAlways);
  params.shelf.free_bytes_min = std::uint64_t{1} << 60;
  TestRecorder t(params);
  record_one_by_one(t.recorder, 1, 3, nullptr);
  EXPECT_EQ(t.recorder.counters().write_failed, 3u);
  EXPECT_EQ(t.recorder.counters().last_errno, ENOSPC);
  EXPECT_TRUE(recordings_in(folder.path()).empty());
}

// Files may not grow beyond a limit: in the middle of an image the disk says no.
TEST(RecorderDisk, AWriteThatFailsLeavesNoHalves) {
  const TemporaryFolder folder;
  const TestFrame frame(96, 64, 1);
  TestRecorder t(test_params(folder.path(), RecordMode::kAlways));
  record_one_by_one(t.recorder, 1, 2, &frame.frame);
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit small{5000, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  record_one_by_one(t.recorder, 3, 6, &frame.frame);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  EXPECT_EQ(t.recorder.counters().write_failed, 4u);
  EXPECT_EQ(t.recorder.counters().last_errno, EFBIG);
  expect_whole(folder.path());
  record_one_by_one(t.recorder, 7, 7, &frame.frame);
  EXPECT_EQ(t.recorder.counters().written, 3u);
  EXPECT_EQ(t.recorder.counters().last_errno, 0);
  expect_whole(folder.path());
  EXPECT_EQ(lines_of(recordings_in(folder.path()).at(0)).size(), 3u);
}

// In a child with a file system of its own, of half a MiB. Exit status 77: it may have none.
void record_on_a_full_disk(const std::string& folder) {
  const auto mounted = [&] { return mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=512k") == 0; };
  if (unshare(CLONE_NEWNS) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) _exit(77);
  if (mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 || !mounted()) _exit(77);
  {
    const TestFrame frame(96, 64, 1);
    TestRecorder t(test_params(folder, RecordMode::kAlways));
    record_one_by_one(t.recorder, 1, 60, &frame.frame);
    const RecorderCounters c = t.recorder.counters();
    EXPECT_GT(c.written, 5u);
    EXPECT_GT(c.write_failed, 5u);
    EXPECT_EQ(c.last_errno, ENOSPC);
    expect_whole(folder);
    // Room again: it goes on by itself.
    fs::remove_all(recordings_in(folder).at(0) + "/test/000001/gray/000000.png");
    for (int i = 1; i < 8; ++i)
      fs::remove(recordings_in(folder).at(0) + "/test/000001/depth/00000" + std::to_string(i) +
                 ".png");
    const std::uint64_t before = t.recorder.counters().written;
    record_one_by_one(t.recorder, 61, 61, &frame.frame);
    EXPECT_EQ(t.recorder.counters().written, before + 1);
  }
  _exit(testing::Test::HasFailure() ? 1 : 0);
}

TEST(RecorderDisk, AFullDiskIsCountedAndLeavesNoHalves) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) record_on_a_full_disk(folder.path());
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "SKIPPED: no file system of its own is allowed";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

// The next image's temporary file is a pipe that nobody reads: opening it hangs.
TEST(RecorderDisk, ADiskThatHangsCostsRecordingsAndNoCycle) {
  const TemporaryFolder folder;
  const TestFrame frame(96, 64, 1);
  TestRecorder t(test_params(folder.path(), RecordMode::kAlways));
  record_one_by_one(t.recorder, 1, 1, &frame.frame);
  const std::string pipe = recordings_in(folder.path()).at(0) + "/test/000001/depth/000001.png.new";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  // Whenever the writer comes to the pipe, it gets no further.
  for (std::uint64_t cycle = 2; cycle <= 101; ++cycle) {
    t.recorder.record(TestCycle(cycle, &frame.frame).record);
  }
  EXPECT_EQ(t.recorder.counters().recorded, 101u);
  EXPECT_GE(t.recorder.counters().overwritten, 96u);
  EXPECT_EQ(t.recorder.counters().written, 1u);
  // The disk comes back: the pipe gets a reader, then fails as no file does, and what waits goes
  // on.
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  char bytes[4096];
  EXPECT_TRUE(holds_in_time([&] {
    while (read(reader, bytes, sizeof bytes) > 0) {
    }
    return handled(t.recorder) == 101;
  }));
  close(reader);
  EXPECT_GE(t.recorder.counters().written, 4u);
}

TEST(RecorderDisk, AFolderThatCannotBeUsedIsRefusedAtStart) {
  const TemporaryFolder folder;
  std::ofstream(folder.file("file")) << "no folder\n";
  CycleRecorderParams params = test_params(folder.path(), RecordMode::kAlways);
  params.shelf.folder = folder.file("file") + "/recordings";
  Arena arena(CycleRecorder::footprint(params));
  EXPECT_THROW(CycleRecorder(params, test_configuration(""), arena), SetupError);
}

}  // namespace
}  // namespace binpick::app
