// A scene as an organized point cloud, and files of it as the makers of sensors write them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "binpick/geometry/lens_distortion.hpp"

namespace binpick::drivers {

// A slanted plane with a hole; each pixel has its point, its gray, or neither.
struct CloudScene {
  CameraIntrinsics camera{48, 36, 90, 91, 23.2, 18.1};
  LensDistortion lens;
  double units_per_mm = 1;
  float missing = 0;  // of all three coordinates

  int count() const { return camera.width * camera.height; }
  bool measured(int i) const { return i % 7 != 3; }
  double depth_mm(int i) const;  // 0 where nothing is measured
  int gray(int i) const { return 20 + i % 200; }
  std::array<float, 3> point(int i) const;
};

enum class CloudEncoding { kAscii, kBinary, kBigEndian, kCompressed };

struct CloudStyle {
  CloudEncoding encoding = CloudEncoding::kBinary;
  std::vector<std::string> header;  // lines of the PLY header: comments, obj_info
  std::string gray;                 // "uchar intensity", "float intensity", "ushort gray", "rgb"
  double gray_scale = 1;
  bool organized = true;  // PCD: by WIDTH and HEIGHT
};

void write_ply(const std::string& path, const CloudScene& scene, const CloudStyle& style);
// Only what was measured, and a range_grid that says where.
void write_range_grid_ply(const std::string& path, const CloudScene& scene);
void write_pcd(const std::string& path, const CloudScene& scene, const CloudStyle& style);

}  // namespace binpick::drivers
