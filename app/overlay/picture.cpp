#include "overlay/picture.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace binpick::app {
namespace {

struct DepthRange {
  float near_mm = 0, far_mm = 0;
};

DepthRange stretch_of(ImageView<const float> depth_mm, const Roi& roi) {
  const auto [x0, y0, x1, y1] = pixels_of(roi, depth_mm.width, depth_mm.height);
  std::vector<float> measured;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const float z = depth_mm.at(x, y);
      if (is_measured(z)) measured.push_back(z);
    }
  }
  if (measured.empty()) return {};
  const auto percentile = [&measured](double share) {
    const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(measured.size() - 1));
    std::nth_element(measured.begin(), measured.begin() + k, measured.end());
    return measured[static_cast<std::size_t>(k)];
  };
  return {percentile(0.02), percentile(0.98)};
}

}  // namespace

Picture picture_from_gray(ImageView<const std::uint8_t> gray) {
  Picture picture{gray.width, gray.height, {}};
  picture.rgb.reserve(3 * static_cast<std::size_t>(gray.width) * gray.height);
  for (int y = 0; y < gray.height; ++y) {
    for (int x = 0; x < gray.width; ++x) picture.rgb.insert(picture.rgb.end(), 3, gray.at(x, y));
  }
  return picture;
}

Picture colour_map_depth(ImageView<const float> depth_mm, const Roi& roi) {
  cv::Mat ramp(1, 256, CV_8U), colours;
  for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(255 - i);
  cv::applyColorMap(ramp, colours, cv::COLORMAP_TURBO);

  Picture picture{depth_mm.width, depth_mm.height, {}};
  picture.rgb.assign(3 * static_cast<std::size_t>(depth_mm.width) * depth_mm.height, 0);
  const DepthRange range = stretch_of(depth_mm, roi);
  const float span = std::max(range.far_mm - range.near_mm, 1e-3f);
  for (int y = 0; y < depth_mm.height; ++y) {
    for (int x = 0; x < depth_mm.width; ++x) {
      const float z = depth_mm.at(x, y);
      if (!is_measured(z)) continue;
      const float share = std::clamp((z - range.near_mm) / span, 0.0f, 1.0f);
      const cv::Vec3b bgr = colours.at<cv::Vec3b>(0, static_cast<int>(255 * share));
      for (int c = 0; c < 3; ++c) picture.pixel(x, y)[c] = bgr[2 - c];
    }
  }
  return picture;
}

Picture crop_to_roi(const Picture& picture, const Roi& roi, int margin_px) {
  if (roi.whole_image()) return picture;
  const int x0 = std::clamp(roi.x - margin_px, 0, picture.width);
  const int y0 = std::clamp(roi.y - margin_px, 0, picture.height);
  const int x1 = std::clamp(roi.x + roi.width + margin_px, x0, picture.width);
  const int y1 = std::clamp(roi.y + roi.height + margin_px, y0, picture.height);
  if (x0 == x1 || y0 == y1) return picture;
  Picture crop{x1 - x0, y1 - y0, {}};
  for (int y = y0; y < y1; ++y) {
    crop.rgb.insert(crop.rgb.end(), picture.pixel(x0, y), picture.pixel(x0, y) + 3 * crop.width);
  }
  return crop;
}

std::vector<std::uint8_t> encode_png(const Picture& picture) {
  const cv::Mat rgb(picture.height, picture.width, CV_8UC3,
                    const_cast<std::uint8_t*>(picture.rgb.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", bgr, bytes, {cv::IMWRITE_PNG_COMPRESSION, 6});
  return bytes;
}

void write_png(const Picture& picture, const std::string& path) {
  const std::vector<std::uint8_t> bytes = encode_png(picture);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw std::runtime_error(path + ": the picture cannot be written");
}

}  // namespace binpick::app
