// A small part for the tests of poses and detection: an L-shaped bracket with a boss, without any
// symmetry, its origin away from its centre; a model of it, trained once per program; and scenes
// rendered from it.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "binpick/frame/frame.hpp"
#include "binpick/geometry/angle.hpp"
#include "binpick/model/object_model.hpp"
#include "binpick/train/mesh.hpp"

namespace binpick {

train::Mesh bracket_mesh();
train::ImportedMesh bracket_part();

// 480 x 360 px; the bracket spans about 120 px at the middle of the distances trained for.
CameraIntrinsics bracket_camera();

// Trained coarsely, for views up to 50 degrees from above and 460 to 540 mm. The same for all tests
// of a program.
const ObjectModel& bracket_model();
const std::vector<std::uint8_t>& bracket_model_bytes();  // aligned as parse() wants it

// A model of it that takes no time to train: a tree of two depths, few rolls, 10 samples.
std::vector<std::uint8_t> tiny_model_bytes();

// The part seen from above, tilted by `tilt_deg` towards `azimuth_deg` and rolled.
Pose bracket_pose(double tilt_deg, double azimuth_deg, double roll_deg, const Vec3& t_mm);

// Brackets on a plane, shaded gray; exact depth.
struct BracketScene {
  std::vector<float> depth_mm;
  std::vector<std::uint8_t> gray;
  CameraIntrinsics camera;
  std::vector<Pose> truth;

  Frame frame() const {
    return {{depth_mm.data(), camera.width, camera.height, camera.width},
            {gray.data(), camera.width, camera.height, camera.width},
            camera,
            {},
            0,
            0};
  }
};
// `noise_mm`: standard deviation of the depth.
BracketScene render_brackets(const CameraIntrinsics& camera, const std::vector<Pose>& poses,
                             double noise_mm = 0);

// Three of them side by side.
std::vector<Pose> three_brackets();

inline Vec3 random_unit(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

struct PoseError {
  double angle_deg = 0, shift_mm = 0;
  bool within(double angle_limit_deg, double shift_limit_mm) const {
    return angle_deg <= angle_limit_deg && shift_mm <= shift_limit_mm;
  }
};
inline PoseError pose_error(const Pose& T, const Pose& truth) {
  return {rotation_angle_between(T.R, truth.R) / kDegree, (T.t_mm - truth.t_mm).norm()};
}

}  // namespace binpick
