// Images of which the end is missing: refused whatever their format, and told to be cut short.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "../temporary_folder.hpp"
#include "binpick/drivers/loaded_frame.hpp"

namespace binpick::drivers {
namespace {

using testing::HasSubstr;

cv::Mat picture() {
  cv::Mat image(120, 160, CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(x * y * 7 + (x ^ y));
  return image;
}

std::string encoded(const std::string& extension, const std::vector<int>& parameters = {}) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, picture(), bytes, parameters);
  return {bytes.begin(), bytes.end()};
}

// A JPEG as cameras write it: with a thumbnail, which is a whole JPEG, in a segment before it.
std::string with_thumbnail(const std::string& jpeg) {
  const std::string thumbnail = "Exif" + std::string(2, '\0') + jpeg.substr(0, 200) + "\xFF\xD9";
  const std::size_t length = thumbnail.size() + 2;
  return jpeg.substr(0, 2) + "\xFF\xE1" + static_cast<char>(length >> 8) +
         static_cast<char>(length & 0xFF) + thumbnail + jpeg.substr(2);
}

std::string fault_of(const std::string& path) {
  FrameCamera camera;
  camera.intrinsics = {160, 120, 200, 200, 79.5, 59.5};
  try {
    load_frame_files("", path, camera);
  } catch (const DatasetError& error) {
    return error.what();
  }
  return "";
}

TEST(ImagesCutShort, AreRefused) {
  const struct {
    const char *name, *fault;
    std::string bytes;
  } cases[] = {
      {"a.jpg", "cut short", encoded(".jpg")},
      {"progressive.jpg", "cut short", encoded(".jpg", {cv::IMWRITE_JPEG_PROGRESSIVE, 1})},
      {"restarts.jpg", "cut short", encoded(".jpg", {cv::IMWRITE_JPEG_RST_INTERVAL, 3})},
      {"thumbnail.jpg", "cut short", with_thumbnail(encoded(".jpg"))},
      {"a.png", "cut short", encoded(".png")},
      {"a.tif", "damaged", encoded(".tif")},
  };
  const TemporaryFolder folder;
  for (const auto& c : cases) {
    const std::string path = folder.file(c.name);
    for (const double share : {0.3, 0.6, 0.95, 1.0}) {
      SCOPED_TRACE(std::string(c.name) + " " + std::to_string(share));
      const auto kept = static_cast<std::size_t>(share * static_cast<double>(c.bytes.size()));
      std::ofstream(path, std::ios::binary) << c.bytes.substr(0, kept);
      if (share < 1) {
        EXPECT_THAT(fault_of(path), testing::AllOf(HasSubstr(path), HasSubstr(c.fault)));
      } else {
        EXPECT_EQ(fault_of(path), "");
      }
    }
    std::ofstream(path, std::ios::binary) << c.bytes << "made by a test";
    EXPECT_EQ(fault_of(path), "") << c.name << " with more after its end";
  }
}

}  // namespace
}  // namespace binpick::drivers
