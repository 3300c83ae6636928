// Intensity images of 8 to 16 bits a channel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "inputs/input_files.hpp"

namespace binpick::drivers {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int kGrayWidth = 6, kGrayHeight = 4;
const FrameCamera kGrayCamera{{0, 0, 500, 500, 3, 2}, {}, {}, {}, 0, 0, {}};

// How many bits a sensor uses shows in its brightest pixel.
TEST(IntensityFiles, OfTenToSixteenBitsBecomeEight) {
  struct Case {
    std::uint16_t brightest;
    int bits;
  };
  const TemporaryFolder folder;
  const std::string path = folder.file("gray.png");
  for (const Case& c : {Case{255, 8}, Case{256, 10}, Case{1023, 10}, Case{1024, 12}, Case{4095, 12},
                        Case{4096, 14}, Case{16383, 14}, Case{16384, 16}, Case{65535, 16}}) {
    SCOPED_TRACE(c.brightest);
    std::vector<std::uint16_t> pixels(kGrayWidth * kGrayHeight, 0);
    pixels[0] = c.brightest;
    pixels[1] = static_cast<std::uint16_t>(c.brightest / 2);
    ASSERT_TRUE(cv::imwrite(path, cv::Mat(kGrayHeight, kGrayWidth, CV_16UC1, pixels.data())));
    const LoadedFrame frame = load_frame_files("", path, kGrayCamera);
    EXPECT_EQ(frame.intensity[0], c.brightest >> (c.bits - 8));
    EXPECT_EQ(frame.intensity[1], c.brightest / 2 >> (c.bits - 8));
    EXPECT_EQ(frame.intensity[2], 0);
  }
}

TEST(IntensityFiles, OfSixteenBitsInColourBecomeGray) {
  const TemporaryFolder folder;
  const std::string path = folder.file("rgb.png");
  ASSERT_TRUE(
      cv::imwrite(path, cv::Mat(kGrayHeight, kGrayWidth, CV_16UC3, cv::Scalar(0, 0, 4000))));
  const LoadedFrame frame = load_frame_files("", path, kGrayCamera);
  EXPECT_NEAR(frame.intensity[0], 0.299 * 4000 / 16, 1) << "as gray it uses 11 bits";
}

TEST(IntensityFiles, WhatIsNoImageIsRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.file("gray.npy");
  write_text(path, "\x93NUMPY");
  EXPECT_THAT(error_of([&] { load_frame_files("", path, kGrayCamera); }),
              AllOf(HasSubstr("NumPy array"), HasSubstr("not an intensity image")));
}

}  // namespace
}  // namespace binpick::drivers
