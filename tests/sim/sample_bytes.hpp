// What a simulated sensor has to send of the sample bins: the files' own bytes, read here without
// any of the simulator's code.
#pragma once

#include <cstdint>
#include <cstdio>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace binpick {

inline const std::string kSampleBin = std::string(BINPICK_TEST_DATA) + "/bin-sample";

// Decoded once: a test compares many frames, at the sensor's frame rate.
inline const std::vector<std::uint8_t>& image_bytes(int scene, const char* kind, int image) {
  char path[512];
  std::snprintf(path, sizeof path, "%s/test/%06d/%s/%06d.png", kSampleBin.c_str(), scene, kind,
                image);
  static std::map<std::string, std::vector<std::uint8_t>> decoded;
  const auto known = decoded.find(path);
  if (known != decoded.end()) return known->second;
  const cv::Mat pixels = cv::imread(path, cv::IMREAD_UNCHANGED);
  if (pixels.empty()) throw std::runtime_error(std::string(path) + ": cannot be read");
  return decoded[path] = {pixels.data, pixels.data + pixels.total() * pixels.elemSize()};
}

}  // namespace binpick
