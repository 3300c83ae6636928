// What the recorder is made of: depth codes, image files, the ring.
#include <fcntl.h>
#include <gmock/gmock.h>

#include <atomic>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <thread>

#include "binpick/drivers/depth_code.hpp"
#include "operation/recorded_frame.hpp"
#include "recorder/depth_codes.hpp"
#include "temporary_folder.hpp"

namespace binpick::app {
namespace {

using drivers::depth_mm_from_code;

TEST(DepthCodes, EveryCodeComesBackAtAnyScale) {
  for (const double scale_mm : {0.001, 0.05, 0.1, 1.0 / 3, 0.1234567, 0.25, 1.0, 17.3}) {
    std::vector<float> depth(65536);
    for (int code = 0; code < 65536; ++code)
      depth[static_cast<std::size_t>(code)] = depth_mm_from_code(code, scale_mm);
    Frame frame;
    frame.depth_mm = {depth.data(), 256, 256, 256};
    frame.depth_scale_mm = scale_mm;
    std::vector<std::uint16_t> codes(depth.size());
    depth_codes(frame, scale_mm, codes);
    for (std::size_t code = 0; code < codes.size(); ++code) ASSERT_EQ(codes[code], code);
  }
}

TEST(DepthCodes, FloatsAreRoundedOnceAndThenStay) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<float> depth = {500.04f, 500.06f, kNan,    kInfinity, -kInfinity, -3,
                              0,       0.04f,   6553.5f, 6553.6f,   1e30f,      612.345f};
  FrameSlot slot;
  slot.depth_mm = depth;
  slot.frame.depth_mm = {depth.data(), 4, 3, 4};
  quantize_depth(slot);
  const auto is = [](int code) { return depth_mm_from_code(code, 0.1); };
  EXPECT_THAT(
      depth, testing::ElementsAre(is(5000), is(5001), 0, 0, 0, 0, 0, 0, is(65535), 0, 0, is(6123)));
  EXPECT_EQ(slot.frame.depth_scale_mm, 0.1);
  const std::vector<float> once = depth;
  slot.frame.depth_scale_mm = 0;
  quantize_depth(slot);
  EXPECT_EQ(depth, once);
  slot.frame.depth_scale_mm = 7;
  quantize_depth(slot);
  EXPECT_EQ(depth, once);
}

class PngFile : public testing::Test {
 protected:
  template <class T>
  cv::Mat write_and_read(const std::vector<T>& pixels, int width) {
    const std::string path = folder_.file("image.png");
    const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const std::int64_t bytes = png_.write(fd, pixels, width);
    EXPECT_EQ(bytes, lseek(fd, 0, SEEK_CUR));
    close(fd);
    return cv::imread(path, cv::IMREAD_UNCHANGED);
  }

  TemporaryFolder folder_;
  Arena arena_{PngWriter::footprint(1280)};
  PngWriter png_{1280, arena_};
};

TEST_F(PngFile, ComesBackThroughAnotherDecoder) {
  EXPECT_EQ(arena_.used_bytes(), PngWriter::footprint(1280));
  std::mt19937 random(20260103);
  for (const auto& [width, height] : {std::pair(1, 1), {1280, 1024}, {7, 300}, {333, 2}}) {
    for (const bool noise : {true, false}) {
      std::vector<std::uint16_t> depth;
      std::vector<std::uint8_t> gray;
      for (int i = 0; i < width * height; ++i) {
        depth.push_back(static_cast<std::uint16_t>(noise ? random() : unsigned(i) / 97));
        gray.push_back(static_cast<std::uint8_t>(noise ? random() : unsigned(i) / 311));
      }
      const cv::Mat read16 = write_and_read(depth, width);
      ASSERT_EQ(read16.type(), CV_16UC1);
      ASSERT_EQ(read16.size(), cv::Size(width, height));
      EXPECT_TRUE(std::equal(depth.begin(), depth.end(), read16.begin<std::uint16_t>()));
      const cv::Mat read8 = write_and_read(gray, width);
      ASSERT_EQ(read8.type(), CV_8UC1);
      ASSERT_EQ(read8.size(), cv::Size(width, height));
      EXPECT_TRUE(std::equal(gray.begin(), gray.end(), read8.begin<std::uint8_t>()));
    }
  }
}

TEST_F(PngFile, FullDiskIsAnError) {
  const int fd = open("/dev/full", O_WRONLY);
  ASSERT_GE(fd, 0);
  EXPECT_EQ(png_.write(fd, std::vector<std::uint8_t>(100), 10), -1);
  EXPECT_EQ(errno, ENOSPC);
  close(fd);
  // And the next one is right again.
  EXPECT_EQ(write_and_read(std::vector<std::uint8_t>(100, 7), 10).at<std::uint8_t>(9, 9), 7);
}

struct TestRing {
  RecordRingParams params{3, 8, 8};
  Arena arena{RecordRing::footprint(params)};
  RecordRing ring{params, arena};

  void put(std::uint64_t cycle, bool wanted) { ring.put(TestCycle(cycle).record, 0, wanted); }
  std::uint64_t take() {
    const KeptRecord* record = ring.take();
    if (record == nullptr) return 0;
    const std::uint64_t cycle = record->cycle;
    ring.give_back(record);
    return cycle;
  }
};

TEST(RecordRing, GivesTheOldestFirst) {
  TestRing t;
  EXPECT_EQ(t.take(), 0u);
  for (const std::uint64_t cycle : {5, 6, 7}) t.put(cycle, true);
  EXPECT_EQ(t.take(), 5u);
  t.put(8, true);
  EXPECT_EQ(t.take(), 6u);
  EXPECT_EQ(t.take(), 7u);
  EXPECT_EQ(t.take(), 8u);
  EXPECT_EQ(t.take(), 0u);
  EXPECT_EQ(t.ring.overwritten_count(), 0u);
}

TEST(RecordRing, FullLosesTheOldestThatIsNotBeingWritten) {
  TestRing t;
  for (const std::uint64_t cycle : {1, 2, 3}) t.put(cycle, true);
  const KeptRecord* first = t.ring.take();
  ASSERT_NE(first, nullptr);
  for (const std::uint64_t cycle : {4, 5}) t.put(cycle, true);
  EXPECT_EQ(first->cycle, 1u);
  EXPECT_EQ(t.ring.overwritten_count(), 2u);
  t.ring.give_back(first);
  EXPECT_EQ(t.take(), 4u);
  EXPECT_EQ(t.take(), 5u);
}

TEST(RecordRing, KeepsWithoutWritingUntilAskedFor) {
  TestRing t;
  for (const std::uint64_t cycle : {1, 2, 3, 4}) t.put(cycle, false);
  EXPECT_EQ(t.take(), 0u);
  t.ring.want_all();
  EXPECT_EQ(t.take(), 2u);
  EXPECT_EQ(t.take(), 3u);
  EXPECT_EQ(t.take(), 4u);
  t.ring.want_all();
  EXPECT_EQ(t.take(), 0u) << "written twice";
  EXPECT_EQ(t.ring.overwritten_count(), 0u);
}

TEST(RecordRing, FrameThatIsTooLargeIsLeftOutAndCounted) {
  TestRing t;
  const TestFrame large(9, 8, 1);
  t.ring.put(TestCycle(1, &large.frame).record, 0, true);
  const KeptRecord* record = t.ring.take();
  ASSERT_NE(record, nullptr);
  EXPECT_EQ(record->frame.camera.width, 0);
  EXPECT_EQ(t.ring.too_large_count(), 1u);
}

// Each record is whole and newer than the one before, whatever the other thread does.
TEST(RecordRing, TwoThreadsNeverShareARecord) {
  TestRing t;
  std::atomic<bool> done{false};
  std::thread producer([&] {
    for (std::uint64_t cycle = 1; cycle <= 20000; ++cycle) {
      const TestFrame frame(8, 8, cycle);
      t.ring.put(TestCycle(cycle, &frame.frame).record, 0, cycle % 3 != 0);
      if (cycle % 50 == 0) t.ring.want_all();
    }
    done = true;
  });
  std::uint64_t taken = 0;
  bool again = true;
  while (again) {
    again = !done;
    while (const KeptRecord* record = t.ring.take()) {
      ++taken;
      const TestFrame frame(8, 8, record->cycle);
      std::vector<std::uint16_t> codes(64);
      depth_codes(frame.frame, 0.1, codes);
      ASSERT_TRUE(std::equal(codes.begin(), codes.end(), record->frame_codes().begin()));
      ASSERT_EQ(record->command[0], static_cast<std::uint16_t>(record->cycle));
      t.ring.give_back(record);
    }
  }
  producer.join();
  EXPECT_GT(taken, 0u);
}

}  // namespace
}  // namespace binpick::app
