#include "config/pose_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "binpick/geometry/angle.hpp"
#include "binpick/geometry/pose.hpp"
#include "config/config_file.hpp"
#include "station/recipe_set.hpp"

namespace binpick::app {
namespace {

// Hand-eye calibrations are printed with four digits and more.
constexpr double kInexact = 0.01;
// A sensor is farther than this from the robot's base and flange, in mm; in metres it is not.
constexpr double kLooksLikeMetres = 5;
// A full turn in radians; rotations that are all less than 0.2 degrees are none.
constexpr double kLooksLikeRadians = 2 * kPi, kNoTurn = 0.2;

using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

std::string length_text(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", number);
  return text;
}

void check_quaternion(const char* key, const std::vector<double>& q, ConfigReader& reader) {
  if (q.empty()) return;
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (std::abs(length - 1) > kInexact)
    reader.fault(key, "is no rotation: its length is " + length_text(length) + " instead of 1");
}

void check_matrix(const char* key, const std::vector<double>& values, ConfigReader& reader) {
  if (values.empty()) return;
  const Eigen::Map<const Matrix4> T(values.data());
  const Mat3 R = T.topLeftCorner<3, 3>();
  const auto is_last = [](const Eigen::Vector4d& v) {
    return (v - Eigen::Vector4d(0, 0, 0, 1)).norm() < 1e-6;
  };
  if (!is_last(T.row(3).transpose())) {
    return reader.fault(key, is_last(T.col(3)) ? "is written column by column: write it row by row"
                                               : "its last row is not [0, 0, 0, 1]");
  }
  if ((R.transpose() * R - Mat3::Identity()).cwiseAbs().maxCoeff() > kInexact)
    return reader.fault(key, "is no rotation: its columns are not orthogonal unit vectors");
  if (R.determinant() < 0) reader.fault(key, "is no rotation: it mirrors (its determinant is -1)");
}

bool all_below(const std::array<double, 3>& values, double limit) {
  return std::all_of(values.begin(), values.end(), [&](double v) { return std::abs(v) <= limit; });
}

void add_warnings(const PoseKeys& keys, const WrittenPose& pose, const std::string& file,
                  std::vector<ConfigFault>& warnings) {
  const Vec3 t = pose_of(pose).t_mm;
  const std::array<double, 3> position = {t.x(), t.y(), t.z()};
  if (t != Vec3::Zero() && all_below(position, kLooksLikeMetres)) {
    warnings.push_back(fault_at(file, pose.matrix.empty() ? keys.position : keys.matrix,
                                "the position looks like metres; it is read as mm"));
  }
  if (!all_below(pose.rotation_deg, kNoTurn) && all_below(pose.rotation_deg, kLooksLikeRadians)) {
    warnings.push_back(fault_at(file, keys.rotation, "looks like radians; it is read as degrees"));
  }
}

}  // namespace

void check_pose(const PoseKeys& keys, const WrittenPose& pose, ConfigReader& reader) {
  check_quaternion(keys.wxyz, pose.quaternion_wxyz, reader);
  check_quaternion(keys.xyzw, pose.quaternion_xyzw, reader);
  check_matrix(keys.matrix, pose.matrix, reader);
  const auto used = [](const auto& values) {
    return std::any_of(values.begin(), values.end(), [](double v) { return v != 0; });
  };
  const int rotations = used(pose.rotation_deg) + used(pose.quaternion_wxyz) +
                        used(pose.quaternion_xyzw) + used(pose.matrix);
  if (rotations > 1) {
    const char* one = !pose.matrix.empty()            ? keys.matrix
                      : !pose.quaternion_wxyz.empty() ? keys.wxyz
                                                      : keys.xyzw;
    reader.fault(one, "the rotation is written in another way too: leave one");
  } else if (used(pose.matrix) && used(pose.position_mm)) {
    reader.fault(keys.matrix, "has the position too: leave out " + std::string(keys.position));
  }
}

std::vector<ConfigFault> pose_warnings(const Config& config) {
  std::vector<ConfigFault> warnings;
  const StationConfig& c = config.station;
  add_warnings(kBaseCamKeys, c.T_base_cam, config.file, warnings);
  add_warnings(kFlangeCamKeys, c.T_flange_cam, config.file, warnings);
  if (c.pose_frame != PoseFrame::kBase) return warnings;
  const bool fixed = c.mounting == Mounting::kFixed;
  const Pose T = pose_of(fixed ? c.T_base_cam : c.T_flange_cam);
  if (T.t_mm == Vec3::Zero() && rotation_angle_between(T.R, Mat3::Identity()) < 1e-9) {
    warnings.push_back(
        fault_at(config.file, "station.pose_frame",
                 std::string("is \"base\", but ") + (fixed ? "T_base_cam" : "T_flange_cam") +
                     " is the identity: write the sensor's place, from a hand-eye calibration"));
  }
  return warnings;
}

}  // namespace binpick::app
