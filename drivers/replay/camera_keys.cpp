#include "replay/camera_keys.hpp"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <vector>

namespace binpick::drivers {
namespace {

// Those that are read, as a person would write them.
constexpr std::string_view kReadKeys[] = {"fx",
                                          "fy",
                                          "cx",
                                          "cy",
                                          "ppx",
                                          "ppy",
                                          "cam_K",
                                          "K",
                                          "camera_matrix",
                                          "intrinsic_matrix",
                                          "mtx",
                                          "intrinsics",
                                          "width",
                                          "height",
                                          "image_width",
                                          "image_height",
                                          "image_size",
                                          "resolution",
                                          "depth_scale",
                                          "roi",
                                          "capture_ns",
                                          "device_ns",
                                          "distortion_model",
                                          "model",
                                          "distortion_coefficients",
                                          "distortion_coeffs",
                                          "distortion",
                                          "dist_coeffs",
                                          "dist_coeff",
                                          "dist",
                                          "coeffs",
                                          "D",
                                          "k1",
                                          "k2",
                                          "k3",
                                          "k4",
                                          "k5",
                                          "k6",
                                          "p1",
                                          "p2",
                                          "binning_x",
                                          "binning_y"};

// Those that do not change what is read.
constexpr std::string_view kHarmlessKeys[] = {"R",
                                              "P",
                                              "rectification_matrix",
                                              "projection_matrix",
                                              "frame_id",
                                              "header",
                                              "camera_name",
                                              "camera_model",
                                              "name",
                                              "serial",
                                              "serial_number",
                                              "device",
                                              "sensor",
                                              "date",
                                              "time",
                                              "comment",
                                              "version",
                                              "version_major",
                                              "version_minor",
                                              "class_name",
                                              "type",
                                              "id",
                                              "unit",
                                              "units",
                                              "extrinsic",
                                              "extrinsics",
                                              "extrinsic_parameters",
                                              "cam_R_w2c",
                                              "cam_t_w2c",
                                              "view_level",
                                              "calibration_time",
                                              "nframes",
                                              "nr_of_frames",
                                              "board_width",
                                              "board_height",
                                              "square_size",
                                              "marker_size",
                                              "aspect_ratio",
                                              "flags",
                                              "fix_aspect_ratio",
                                              "fix_principal_point",
                                              "zero_tangential_dist",
                                              "avg_reprojection_error",
                                              "per_view_reprojection_errors",
                                              "rms",
                                              "reprojection_error",
                                              "image_points",
                                              "grid_points",
                                              "fps",
                                              "color_format",
                                              "depth_format",
                                              "device_name",
                                              "serial_num",
                                              "stream_length_usec",
                                              "azimuth",
                                              "elev",
                                              "mode",
                                              "skew"};

// Letters that have to be inserted, removed or replaced to get from one to the other.
int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    int corner = row[0];
    row[0] = static_cast<int>(i) + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const int replaced = corner + (a[i] != b[j]);
      corner = row[j + 1];
      row[j + 1] = std::min({replaced, corner + 1, row[j] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string plain_key(std::string_view key) {
  std::string plain;
  for (const char c : key) {
    if (c != '_' && c != '-' && c != ' ')
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return plain;
}

bool is_known_camera_key(std::string_view plain) {
  const auto is_it = [&](std::string_view key) { return plain_key(key) == plain; };
  return std::any_of(std::begin(kReadKeys), std::end(kReadKeys), is_it) ||
         std::any_of(std::begin(kHarmlessKeys), std::end(kHarmlessKeys), is_it);
}

std::string nearest_camera_key(std::string_view plain) {
  std::string nearest;
  // Of a short word few other letters make another word.
  const int size = static_cast<int>(plain.size());
  int least = size < 4 ? std::min(size, 2) : 1 + std::max(size / 3, 2);
  for (const std::string_view key : kReadKeys) {
    const int distance = edit_distance(plain, plain_key(key));
    if (distance >= least) continue;
    least = distance;
    nearest = key;
  }
  return nearest;
}

}  // namespace binpick::drivers
