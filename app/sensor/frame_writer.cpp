#include "sensor/frame_writer.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "replace_file.hpp"
#include "setup_error.hpp"

namespace fs = std::filesystem;

namespace binpick::app {
namespace {

// Not by cv::imwrite, which does not look whether the last bytes reached the disk.
void write_image(const fs::path& path, const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", image, bytes);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw SetupError(path.string() + ": cannot be written: " + std::strerror(errno));
}

}  // namespace

FrameWriter::FrameWriter(const std::string& folder, double depth_scale)
    : scene_(fs::path(folder) / "test" / "000001"), depth_scale_(depth_scale) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_empty(folder, error))
    throw SetupError(folder + ": exists already and is not empty");
  for (const char* kind : {"depth", "gray"}) {
    fs::create_directories(scene_ / kind, error);
    if (error) throw SetupError((scene_ / kind).string() + ": " + error.message());
  }
}

void FrameWriter::write(const Frame& frame) {
  char name[16];
  std::snprintf(name, sizeof name, "%06d.png", count_);
  cv::Mat codes(frame.depth_mm.height, frame.depth_mm.width, CV_16UC1);
  for (int y = 0; y < codes.rows; ++y) {
    std::uint16_t* row = codes.ptr<std::uint16_t>(y);
    for (int x = 0; x < codes.cols; ++x) {
      const double code = std::round(static_cast<double>(frame.depth_mm.at(x, y)) / depth_scale_);
      row[x] = code > 0 && code <= 65535 ? static_cast<std::uint16_t>(code) : 0;
    }
  }
  write_image(scene_ / "depth" / name, codes);
  if (!frame.intensity.empty()) {
    cv::Mat gray(frame.intensity.height, frame.intensity.width, CV_8UC1);
    for (int y = 0; y < gray.rows; ++y)
      std::copy_n(frame.intensity.row(y), gray.cols, gray.ptr<std::uint8_t>(y));
    write_image(scene_ / "gray" / name, gray);
  }
  const CameraIntrinsics& c = frame.camera;
  cameras_[std::to_string(count_)] = {{"cam_K", {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}},
                                      {"depth_scale", depth_scale_},
                                      {"capture_ns", frame.capture_ns},
                                      {"device_ns", frame.device_ns},
                                      {"sequence", frame.sequence}};
  ++count_;
}

void FrameWriter::finish() {
  std::error_code error;
  if (fs::is_empty(scene_ / "gray", error)) fs::remove(scene_ / "gray", error);
  const std::string json = cameras_.dump(1) + "\n";
  replace_file((scene_ / "scene_camera.json").string(),
               {reinterpret_cast<const std::uint8_t*>(json.data()), json.size()});
}

}  // namespace binpick::app
