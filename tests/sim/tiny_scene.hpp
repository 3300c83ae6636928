// A data set of small images in the BOP layout, for tests that look at every packet.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "../temporary_folder.hpp"

namespace binpick {

class TinyScene {
 public:
  static constexpr int kWidth = 64, kHeight = 48;
  static constexpr double kDepthScale = 0.1, kFx = 100, kFy = 101, kCx = 31.5, kCy = 24.25;

  explicit TinyScene(int image_count) {
    const std::filesystem::path scene = std::filesystem::path(path()) / "test" / "000001";
    std::filesystem::create_directories(scene / "depth");
    std::filesystem::create_directories(scene / "gray");
    std::ofstream camera(scene / "scene_camera.json");
    for (int id = 0; id < image_count; ++id) {
      const std::string name = "00000" + std::to_string(id) + ".png";
      cv::Mat depth(kHeight, kWidth, CV_16UC1), gray(kHeight, kWidth, CV_8UC1);
      for (int i = 0; i < kWidth * kHeight; ++i) {
        depth.at<std::uint16_t>(i / kWidth, i % kWidth) = depth_code(id, i);
        gray.at<std::uint8_t>(i / kWidth, i % kWidth) = gray_value(id, i);
      }
      cv::imwrite((scene / "depth" / name).string(), depth);
      cv::imwrite((scene / "gray" / name).string(), gray);
      camera << (id == 0 ? "{" : ",") << "\"" << id
             << "\":{\"cam_K\":[100,0,31.5,0,101,24.25,0,0,1],\"depth_scale\":0.1}";
    }
    camera << "}";
  }

  const std::string& path() const { return folder_.path(); }

  // Every eleventh pixel holds no measurement.
  static std::uint16_t depth_code(int id, int i) {
    return static_cast<std::uint16_t>(i % 11 == 0 ? 0 : 5000 + 100 * id + i);
  }
  static std::uint8_t gray_value(int id, int i) { return static_cast<std::uint8_t>(7 * i + id); }

  // Depth codes, little-endian, and then the gray values: the data of a block.
  static std::vector<std::uint8_t> block_bytes(int id) {
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < kWidth * kHeight; ++i) {
      bytes.push_back(static_cast<std::uint8_t>(depth_code(id, i)));
      bytes.push_back(static_cast<std::uint8_t>(depth_code(id, i) >> 8));
    }
    for (int i = 0; i < kWidth * kHeight; ++i) bytes.push_back(gray_value(id, i));
    return bytes;
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace binpick
