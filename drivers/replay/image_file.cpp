#include "replay/image_file.hpp"

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "binpick/drivers/depth_code.hpp"
#include "binpick/drivers/loaded_frame.hpp"
#include "replay/image_end.hpp"

namespace binpick::drivers {
namespace {

cv::Mat decode(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw DatasetError(path + ": there is no such file");
  if (ends_too_early(path)) {
    throw DatasetError(path + ": the file was cut short; copy or save it again");
  }
  cv::Mat image;
  try {
    image = cv::imread(path, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& e) {
    throw DatasetError(path + ": cannot be decoded (" + e.err + ")");
  }
  if (image.empty())
    throw DatasetError(path + ": is not an image that can be decoded, or is damaged");
  return image;
}

}  // namespace

ImageBuffer<float> read_depth_mm(const std::string& path, double depth_scale) {
  const cv::Mat raw = decode(path);
  if (raw.type() != CV_16UC1) {
    throw DatasetError(path + ": is not a depth image: one channel of 16 bits is expected, " +
                       std::to_string(raw.channels()) + " of " +
                       std::to_string(8 * raw.elemSize1()) + " found");
  }
  ImageBuffer<float> depth{raw.cols, raw.rows, {}};
  depth.pixels.reserve(raw.total());
  for (int y = 0; y < raw.rows; ++y) {
    const std::uint16_t* row = raw.ptr<std::uint16_t>(y);
    for (int x = 0; x < raw.cols; ++x)
      depth.pixels.push_back(depth_mm_from_code(row[x], depth_scale));
  }
  return depth;
}

ImageBuffer<std::uint8_t> read_gray(const std::string& path) {
  const cv::Mat image = decode(path);
  if (image.depth() != CV_8U) throw DatasetError(path + ": is not an image of 8 bits a channel");
  cv::Mat gray;
  switch (image.channels()) {
    case 1:
      gray = image;
      break;
    case 3:
      cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
      break;
    case 4:
      cv::cvtColor(image, gray, cv::COLOR_BGRA2GRAY);
      break;
    default:
      throw DatasetError(path + ": is neither a gray nor a colour image");
  }
  ImageBuffer<std::uint8_t> buffer{gray.cols, gray.rows, {}};
  buffer.pixels.reserve(gray.total());
  for (int y = 0; y < gray.rows; ++y) {
    const std::uint8_t* row = gray.ptr<std::uint8_t>(y);
    buffer.pixels.insert(buffer.pixels.end(), row, row + gray.cols);
  }
  return buffer;
}

}  // namespace binpick::drivers
