#include "binpick/drivers/loaded_frame.hpp"

#include <cmath>

#include "replay/camera_json.hpp"
#include "replay/image_file.hpp"

namespace binpick::drivers {
namespace {

CameraIntrinsics intrinsics_from_json(const JsonNode& node) {
  CameraIntrinsics c;
  if (const auto cam_K = node.find("cam_K")) {
    const Mat3 K = cam_K->matrix3();
    if (K(0, 1) != 0 || K(1, 0) != 0 || K(2, 0) != 0 || K(2, 1) != 0 || K(2, 2) != 1) {
      cam_K->fail(
          "is not a pinhole camera without skew: [fx, 0, cx, 0, fy, cy, 0, 0, 1] is expected");
    }
    c.fx = K(0, 0);
    c.fy = K(1, 1);
    c.cx = K(0, 2);
    c.cy = K(1, 2);
    if (!c.valid()) cam_K->fail("the focal lengths are not positive");
  } else {
    c.fx = node.at("fx").number();
    c.fy = node.at("fy").number();
    c.cx = node.at("cx").number();
    c.cy = node.at("cy").number();
    if (!c.valid()) node.fail("fx and fy are not positive");
  }
  if (const auto width = node.find("width")) c.width = width->integer();
  if (const auto height = node.find("height")) c.height = height->integer();
  if (c.width < 0 || c.height < 0) node.fail("width and height are negative");
  return c;
}

std::int64_t time_from_json(const JsonNode& node) {
  const double ns = node.number();
  // As exact as a double is: microseconds after a hundred days.
  if (ns < 0 || ns > 9e18) node.fail("is not a time in ns");
  return static_cast<std::int64_t>(ns);
}

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

FrameCamera camera_from_json(const JsonNode& node) {
  FrameCamera camera;
  camera.intrinsics = intrinsics_from_json(node);
  if (const auto scale = node.find("depth_scale")) {
    camera.depth_scale = scale->number();
    if (*camera.depth_scale <= 0) scale->fail("is not positive");
  }
  if (const auto roi = node.find("roi")) {
    const std::vector<JsonNode> v = roi->elements();
    if (v.size() != 4) roi->fail("is not a list of four numbers: x, y, width, height");
    camera.roi = {v[0].integer(), v[1].integer(), v[2].integer(), v[3].integer()};
    if (camera.roi.whole_image()) roi->fail("its width and height are not positive");
  }
  if (const auto time = node.find("capture_ns")) camera.capture_ns = time_from_json(*time);
  if (const auto time = node.find("device_ns")) camera.device_ns = time_from_json(*time);
  return camera;
}

FrameCamera load_camera_file(const std::string& path) {
  const nlohmann::json json = read_json_file(path);
  return camera_from_json(JsonNode(json, path));
}

Frame LoadedFrame::view() const {
  Frame frame;
  if (!depth_mm.empty())
    frame.depth_mm = {depth_mm.data(), camera.width, camera.height, camera.width};
  if (!intensity.empty())
    frame.intensity = {intensity.data(), camera.width, camera.height, camera.width};
  frame.camera = camera;
  frame.depth_scale_mm = depth_scale_mm;
  frame.roi = roi;
  return frame;
}

LoadedFrame load_frame_files(const std::string& depth_path, const std::string& intensity_path,
                             const FrameCamera& camera) {
  LoadedFrame frame;
  frame.camera = camera.intrinsics;
  frame.roi = camera.roi;
  // What sizes the frame, and what it is called where another image differs.
  std::string sized_by;
  const auto take_size = [&](const std::string& path, int width, int height) {
    const std::string is = path + ": is " + size_text(width, height);
    if (!sized_by.empty() && (frame.camera.width != width || frame.camera.height != height)) {
      throw DatasetError(is + ", " + sized_by + " is " +
                         size_text(frame.camera.width, frame.camera.height));
    }
    if ((camera.intrinsics.width != 0 && camera.intrinsics.width != width) ||
        (camera.intrinsics.height != 0 && camera.intrinsics.height != height)) {
      throw DatasetError(is + ", the camera file says " +
                         size_text(camera.intrinsics.width, camera.intrinsics.height));
    }
    frame.camera.width = width;
    frame.camera.height = height;
    sized_by = "its depth image";
  };
  if (!depth_path.empty()) {
    if (!camera.depth_scale) {
      throw DatasetError(depth_path +
                         ": the camera file gives no depth_scale (mm per unit of the depth image)");
    }
    ImageBuffer<float> depth = read_depth_mm(depth_path, *camera.depth_scale);
    take_size(depth_path, depth.width, depth.height);
    frame.depth_scale_mm = *camera.depth_scale;
    frame.depth_mm = std::move(depth.pixels);
  }
  if (!intensity_path.empty()) {
    ImageBuffer<std::uint8_t> gray = read_gray(intensity_path);
    take_size(intensity_path, gray.width, gray.height);
    frame.intensity = std::move(gray.pixels);
  }
  return frame;
}

}  // namespace binpick::drivers
