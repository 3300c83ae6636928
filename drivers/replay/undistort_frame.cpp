#include "replay/undistort_frame.hpp"

#include <cmath>

#include "binpick/frame/undistort_map.hpp"

namespace binpick::drivers {
namespace {

template <class T>
ImageView<T> view_of(std::vector<T>& pixels, const CameraIntrinsics& camera) {
  return {pixels.data(), camera.width, camera.height, camera.width};
}

void check(const std::string& path, const LensDistortion& lens, const CameraIntrinsics& camera) {
  if (!UndistortMap::fits(camera.width, camera.height))
    throw DatasetError(path + ": has an image too small or too large to be undistorted");
  if (const auto fold_px = fold_radius_px(lens, camera)) {
    throw DatasetError(path + ": the lens distortion of its camera turns back " +
                       std::to_string(std::lround(*fold_px)) +
                       " px from the image's centre: the coefficients hold in the middle only; "
                       "calibrate with the pattern up to the image's corners, or with fewer "
                       "coefficients");
  }
}

void undistort(const UndistortMap& map, LoadedFrame& frame) {
  if (frame.intensity.empty()) return;
  std::vector<std::uint8_t> raw = frame.intensity;
  map.intensity(view_of(raw, frame.camera), view_of(frame.intensity, frame.camera));
}

}  // namespace

void undistort(const std::string& path, const LensDistortion& lens, LoadedFrame& frame) {
  if (lens.none()) return;
  check(path, lens, frame.camera);
  Arena arena(UndistortMap::footprint(frame.camera.width, frame.camera.height));
  const UndistortMap map(lens, frame.camera, arena);
  undistort(map, frame);
  if (!frame.depth_mm.empty()) {
    std::vector<float> raw = frame.depth_mm;
    map.depth(view_of(raw, frame.camera), view_of(frame.depth_mm, frame.camera));
  }
  frame.notes.push_back(
      path +
      ": the camera's lens distortion is removed from the images; if they are already "
      "rectified, set its coefficients to 0");
}

void undistort_intensity(const std::string& path, const LensDistortion& lens, LoadedFrame& frame) {
  check(path, lens, frame.camera);
  Arena arena(UndistortMap::footprint(frame.camera.width, frame.camera.height));
  undistort(UndistortMap(lens, frame.camera, arena), frame);
}

}  // namespace binpick::drivers
