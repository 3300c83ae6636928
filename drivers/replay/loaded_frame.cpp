#include "binpick/drivers/loaded_frame.hpp"

#include "replay/cloud_frame.hpp"
#include "replay/undistort_frame.hpp"

namespace binpick::drivers {
namespace {

bool is_cloud(const FileKind& kind) {
  return kind.format == FileFormat::kPly || kind.format == FileFormat::kPcd;
}

FileKind usable_kind(const std::string& path) {
  FileKind kind = kind_of_file(path);
  if (kind.format == FileFormat::kUnsupported)
    throw DatasetError(path + ": is " + kind.name + ", which is not read; " + kind.advice);
  return kind;
}

ImageBuffer<std::uint8_t> load_intensity(const std::string& path) {
  const FileKind kind = usable_kind(path);
  if (kind.format != FileFormat::kImage && kind.format != FileFormat::kUnknown)
    throw DatasetError(path + ": is " + kind.name +
                       ", not an intensity image: expected is PNG, TIFF or JPEG");
  return read_gray(path);
}

// All images of a frame have one size, which is the camera's where its file tells it.
void check_size(const std::string& path, int width, int height, const FrameCamera& camera) {
  const CameraIntrinsics& c = camera.intrinsics;
  if ((c.width == 0 || c.width == width) && (c.height == 0 || c.height == height)) return;
  throw DatasetError(path + ": is " + size_text(width, height) + ", the camera file says " +
                     size_text(c.width, c.height) +
                     ": take the camera file of this resolution; one of another has the wrong "
                     "focal length");
}

void check_same_size(const std::string& intensity_path, int width, int height,
                     const CameraIntrinsics& depth) {
  if (intensity_path.empty() || (width == depth.width && height == depth.height)) return;
  throw DatasetError(intensity_path + ": is " + size_text(width, height) + ", its depth image is " +
                     size_text(depth.width, depth.height));
}

}  // namespace

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

bool is_point_cloud_file(const std::string& path) {
  return is_cloud(usable_kind(path));
}

LoadedFrame load_frame_files(const std::string& depth_path, const std::string& intensity_path,
                             const FrameCamera& camera, std::optional<double> depth_scale) {
  const FileKind kind = depth_path.empty() ? FileKind{} : usable_kind(depth_path);
  ImageBuffer<std::uint8_t> gray;
  const auto take_gray = [&] {
    if (intensity_path.empty()) return;
    gray = load_intensity(intensity_path);
    check_size(intensity_path, gray.width, gray.height, camera);
  };
  if (is_cloud(kind)) {
    take_gray();
    const int width = gray.width, height = gray.height;
    LoadedFrame frame =
        frame_of_cloud(depth_path, kind, camera, std::move(gray), {depth_scale, {}});
    check_size(depth_path, frame.camera.width, frame.camera.height, camera);
    check_same_size(intensity_path, width, height, frame.camera);
    return frame;
  }
  LoadedFrame frame;
  frame.camera = camera.intrinsics;
  frame.roi = camera.roi;
  if (!camera.intrinsics.valid())
    throw DatasetError(depth_path + ": needs the camera that it was taken with: give --camera");
  if (!depth_path.empty()) {
    DepthImage depth = read_depth(depth_path, kind, {depth_scale, camera.depth_scale});
    check_size(depth_path, depth.depth_mm.width, depth.depth_mm.height, camera);
    take_gray();
    frame.camera.width = depth.depth_mm.width;
    frame.camera.height = depth.depth_mm.height;
    check_same_size(intensity_path, gray.width, gray.height, frame.camera);
    frame.depth_scale_mm = depth.step_mm;
    frame.depth_mm = std::move(depth.depth_mm.pixels);
    if (!depth.note.empty()) frame.notes.push_back(depth.note);
  } else {
    take_gray();
    frame.camera.width = gray.width;
    frame.camera.height = gray.height;
  }
  frame.intensity = std::move(gray.pixels);
  undistort(depth_path.empty() ? intensity_path : depth_path, camera.lens, frame);
  return frame;
}

}  // namespace binpick::drivers
