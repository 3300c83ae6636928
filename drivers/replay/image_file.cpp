#include "replay/image_file.hpp"

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

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

template <class T>
std::vector<T> pixels_of(const cv::Mat& image) {
  std::vector<T> pixels;
  pixels.reserve(image.total());
  for (int y = 0; y < image.rows; ++y) {
    const T* row = image.ptr<T>(y);
    pixels.insert(pixels.end(), row, row + image.cols);
  }
  return pixels;
}

}  // namespace

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

RawDepth read_depth_image(const std::string& path) {
  const cv::Mat image = decode(path);
  RawDepth depth{image.cols, image.rows, {}, {}};
  if (image.type() == CV_16UC1) {
    depth.codes = image;
  } else if (image.type() == CV_32FC1 || image.type() == CV_64FC1) {
    cv::Mat values;
    image.convertTo(values, CV_32F);
    depth.values = pixels_of<float>(values);
  } else {
    throw DatasetError(path +
                       ": is not a depth image: one channel of 16 bits or of floating point "
                       "is expected, " +
                       std::to_string(image.channels()) + " of " +
                       std::to_string(8 * image.elemSize1()) + " found");
  }
  return depth;
}

std::vector<std::uint8_t> gray_of_codes(std::span<const std::uint16_t> codes) {
  int shift = 0;
  const auto brightest = codes.empty() ? codes.end() : std::max_element(codes.begin(), codes.end());
  for (int bits = 8; brightest != codes.end() && *brightest >> bits != 0; bits += 2) shift += 2;
  std::vector<std::uint8_t> gray;
  gray.reserve(codes.size());
  for (const std::uint16_t code : codes) gray.push_back(static_cast<std::uint8_t>(code >> shift));
  return gray;
}

ImageBuffer<std::uint8_t> read_gray(const std::string& path) {
  const cv::Mat image = decode(path);
  if (image.depth() != CV_8U && image.depth() != CV_16U)
    throw DatasetError(path + ": is not an image of 8 or 16 bits a channel");
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
  if (gray.depth() == CV_8U) return {gray.cols, gray.rows, pixels_of<std::uint8_t>(gray)};
  return {gray.cols, gray.rows, gray_of_codes(pixels_of<std::uint16_t>(gray))};
}

}  // namespace binpick::drivers
