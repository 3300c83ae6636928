// A frame read from files, with the buffers that it owns, and the camera file that goes with single
// images. Reading is set-up work: every fault is a DatasetError, one sentence that names the file
// and, inside JSON, the entry and the key.
// Thread: any; nothing is shared.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "binpick/frame/frame.hpp"

namespace binpick::drivers {

struct DatasetError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// What a camera file or an entry of scene_camera.json says. width and height of the intrinsics are
// 0 where the file does not give them.
struct FrameCamera {
  CameraIntrinsics intrinsics;
  std::optional<double> depth_scale;  // mm per unit of the depth image
  Roi roi;
  // When it was captured, where the recording says so: by the host's and the sensor's clock. Else
  // 0.
  std::int64_t capture_ns = 0, device_ns = 0;
};

// Reads {fx, fy, cx, cy} or {cam_K}; depth_scale, width, height and roi [x, y, w, h] are optional.
FrameCamera load_camera_file(const std::string& path);

// depth_mm holds 0 where nothing was measured. Either image is empty where the source has none.
struct LoadedFrame {
  std::vector<float> depth_mm;
  std::vector<std::uint8_t> intensity;
  CameraIntrinsics camera;  // width and height are those of the images
  double depth_scale_mm = 0;
  Roi roi;

  // Borrows from this object: valid while it lives and is not moved from.
  Frame view() const;
};

// Reads one frame from a 16-bit depth image and an 8-bit gray or colour image of the same size
// (PNG, TIFF, JPEG). An empty path: the source has none; one of the two must be there.
LoadedFrame load_frame_files(const std::string& depth_path, const std::string& intensity_path,
                             const FrameCamera& camera);

}  // namespace binpick::drivers
