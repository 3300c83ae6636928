// A frame read from files, with the buffers that it owns, and the camera file that goes with single
// images. Reading is set-up work: every fault is a DatasetError, one sentence that names the file
// and, inside JSON or YAML, the entry and the key.
// Thread: any; nothing is shared.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "binpick/frame/frame.hpp"
#include "binpick/geometry/lens_distortion.hpp"

namespace binpick::drivers {

struct DatasetError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// What a camera file or an entry of scene_camera.json says. width and height of the intrinsics are
// 0 where the file does not give them.
struct FrameCamera {
  CameraIntrinsics intrinsics;
  LensDistortion lens;
  std::optional<double> depth_scale;  // mm per unit of the depth image
  Roi roi;
  // When it was captured, where the recording says so: by the host's and the sensor's clock. Else
  // 0.
  std::int64_t capture_ns = 0, device_ns = 0;
  std::vector<std::string> notes;  // for the person who gave the file: sentences that name it
};

// Reads what BOP, OpenCV, ROS, RealSense and Open3D write, and {fx, fy, cx, cy}: JSON, YAML or
// OpenCV's XML. depth_scale, width, height and roi [x, y, w, h] are optional. Of a file with
// several cameras FILE#NAME chooses one.
FrameCamera load_camera_file(const std::string& path);

// The same for a live sensor: its images are taken as those of a pinhole camera, so a lens
// distortion is refused.
FrameCamera load_sensor_camera_file(const std::string& path);

// depth_mm holds 0 where nothing was measured. Either image is empty where the source has none.
// The images are those of a pinhole camera.
struct LoadedFrame {
  std::vector<float> depth_mm;
  std::vector<std::uint8_t> intensity;
  CameraIntrinsics camera;  // width and height are those of the images
  double depth_scale_mm = 0;
  Roi roi;
  std::vector<std::string> notes;  // what was found out or done, and a person should know

  // Borrows from this object: valid while it lives and is not moved from.
  Frame view() const;
};

// Reads one frame from a depth image (16-bit or float PNG, TIFF, OpenEXR, NumPy) or an organized
// point cloud (PLY, PCD), and an image of 8 to 16 bits, gray or colour, of the same size. An empty
// path: the source has none; one of the two must be there. Only with a point cloud may the
// camera's intrinsics be missing (not valid). `depth_scale`: mm per unit, instead of the camera's.
LoadedFrame load_frame_files(const std::string& depth_path, const std::string& intensity_path,
                             const FrameCamera& camera, std::optional<double> depth_scale = {});

// Whether load_frame_files() would read it as a point cloud, which needs no camera.
bool is_point_cloud_file(const std::string& path);

}  // namespace binpick::drivers
