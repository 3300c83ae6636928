#include "eval/part_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "binpick/geometry/angle.hpp"

namespace binpick::app {
namespace {

constexpr int kSurfacePoints = 500;
constexpr int kOuterDirections = 600;
constexpr int kContinuousSteps = 180;

// PCG64 (XSL-RR 128/64), started where numpy's seeding puts it for seed 1.
class Pcg64 {
 public:
  double uniform() {
    constexpr double kTwoToMinus53 = 1.0 / 9007199254740992.0;
    return static_cast<double>(next() >> 11) * kTwoToMinus53;
  }

 private:
  __extension__ using Wide = unsigned __int128;
  static constexpr Wide wide(std::uint64_t high, std::uint64_t low) {
    return static_cast<Wide>(high) << 64 | low;
  }

  std::uint64_t next() {
    state_ = state_ * wide(0x2360ed051fc65da4, 0x4385df649fccf645) +
             wide(0x922af2da2645f895, 0xa19857b95740937b);
    const auto folded =
        static_cast<std::uint64_t>(state_ >> 64) ^ static_cast<std::uint64_t>(state_);
    const auto turn = static_cast<int>(state_ >> 122);
    return folded >> turn | folded << (-turn & 63);
  }

  Wide state_ = wide(0x9c5b484bfedb756c, 0x2a6e7d6f320fbc7e);
};

// Vertices that are outermost in one of many directions spread evenly over the sphere.
std::vector<Vec3> outermost_vertices(const train::Mesh& mesh) {
  std::set<std::size_t> indices;
  for (int i = 0; i < kOuterDirections; ++i) {
    const double k = i + 0.5;
    const double polar = std::acos(1 - 2 * k / kOuterDirections);
    const double azimuth = kPi * (1 + std::sqrt(5.0)) * k;
    const Vec3 direction(std::cos(azimuth) * std::sin(polar), std::sin(azimuth) * std::sin(polar),
                         std::cos(polar));
    std::size_t best = 0;
    double best_height = -1e300;
    for (std::size_t v = 0; v < mesh.vertices_mm.size(); ++v) {
      const double height = mesh.vertices_mm[v].cast<double>().dot(direction);
      if (height > best_height) best = v, best_height = height;
    }
    indices.insert(best);
  }
  std::vector<Vec3> points;
  for (const std::size_t v : indices) points.push_back(mesh.vertices_mm[v].cast<double>());
  return points;
}

Pose rotation_about(const drivers::ContinuousSymmetry& s, double angle_rad) {
  const Mat3 R = rotation_from_vector(s.axis * angle_rad);
  return {R, s.offset_mm - R * s.offset_mm};
}

// Twice the sine of the angle times the axis.
Vec3 antisymmetric_part(const Mat3& R) {
  return {R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)};
}

// The rotation vector straight from the matrix, without a quaternion in between: matrices in
// results files are rounded and not quite orthonormal.
Vec3 rotation_vector_deg(const Mat3& R) {
  const double angle = std::acos(std::clamp((R.trace() - 1) / 2, -1.0, 1.0));
  if (kPi - angle < 1e-4) {  // the antisymmetric part vanishes: take the axis from R + I
    const Mat3 B = (R + Mat3::Identity()) / 2;
    int k = 0;
    B.diagonal().maxCoeff(&k);
    return B.row(k).transpose() * (angle / std::sqrt(std::max(B(k, k), 1e-12)) * 180 / kPi);
  }
  const double scale = angle < 1e-6 ? 0.5 : angle / (2 * std::sin(angle));
  return antisymmetric_part(R) * (scale * 180 / kPi);
}

}  // namespace

std::vector<Vec3> sample_surface(const train::Mesh& mesh, int count) {
  const auto corner = [&mesh](std::size_t t, int i) -> Vec3 {
    return mesh.vertices_mm[mesh.triangles[t][i]].cast<double>();
  };
  std::vector<double> area_below;  // of the triangles up to and including this one
  double total = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    total += (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm();
    area_below.push_back(total);
  }
  if (!(total > 0)) return {};

  Pcg64 random;
  std::vector<std::size_t> chosen;
  for (int i = 0; i < count; ++i) {
    const double area = random.uniform() * total;
    const auto it = std::upper_bound(area_below.begin(), area_below.end() - 1, area);
    chosen.push_back(static_cast<std::size_t>(it - area_below.begin()));
  }
  std::vector<Vec3> points;
  for (const std::size_t t : chosen) {
    const double s = std::sqrt(random.uniform());
    const double r = random.uniform();
    points.push_back(corner(t, 0) * (1 - s) + corner(t, 1) * (s * (1 - r)) +
                     corner(t, 2) * (s * r));
  }
  return points;
}

double relative_error(const PoseError6& error, const PoseLimits& limits) {
  double worst = 0;
  for (int i = 0; i < 6; ++i)
    worst = std::max(worst, std::abs(error[i]) / (i < 3 ? limits.mm : limits.deg));
  return worst;
}

PartGeometry::PartGeometry(const drivers::BopModel& model, const train::Mesh& mesh)
    : diameter_mm_(model.diameter_mm),
      discrete_{Pose{}},
      continuous_(model.symmetries_continuous),
      surface_points_(sample_surface(mesh, kSurfacePoints)),
      outer_points_(outermost_vertices(mesh)) {
  discrete_.insert(discrete_.end(), model.symmetries_discrete.begin(),
                   model.symmetries_discrete.end());
  if (continuous_.empty()) all_symmetries_ = discrete_;
  for (const Pose& d : discrete_) {
    for (const drivers::ContinuousSymmetry& c : continuous_) {
      for (int i = 0; i < kContinuousSteps; ++i) {
        all_symmetries_.push_back(rotation_about(c, 2 * kPi * i / kContinuousSteps) * d);
      }
    }
  }
}

PoseError6 PartGeometry::six_errors(const Pose& estimate, const Pose& truth,
                                    const PoseLimits& limits) const {
  PoseError6 best{};
  double best_relative = 1e300;
  const auto consider = [&](const Pose& candidate) {
    const Vec3 shift = estimate.t_mm - candidate.t_mm;
    const Vec3 turn = rotation_vector_deg(estimate.R * candidate.R.transpose());
    const PoseError6 error{shift.x(), shift.y(), shift.z(), turn.x(), turn.y(), turn.z()};
    const double relative = relative_error(error, limits);
    if (relative < best_relative) best = error, best_relative = relative;
  };
  for (const Pose& d : discrete_) {
    const Pose turned = truth * d;
    if (continuous_.empty()) consider(turned);
    for (const drivers::ContinuousSymmetry& c : continuous_) {
      // The angle about the axis that comes closest to the estimate, in closed form.
      const Mat3 Q = turned.R.transpose() * estimate.R;
      const double angle =
          std::atan2(c.axis.dot(antisymmetric_part(Q)), Q.trace() - c.axis.dot(Q * c.axis));
      consider(turned * rotation_about(c, angle));
    }
  }
  return best;
}

double PartGeometry::add_mm(const Pose& estimate, const Pose& truth) const {
  std::vector<Vec3> estimated;
  for (const Vec3& p : surface_points_) estimated.push_back(estimate * p);
  double sum = 0;
  for (std::size_t i = 0; i < surface_points_.size(); ++i) {
    const Vec3 at_truth = truth * surface_points_[i];
    double nearest_squared = (estimated[i] - at_truth).squaredNorm();
    if (symmetric()) {
      for (const Vec3& q : estimated)
        nearest_squared = std::min(nearest_squared, (q - at_truth).squaredNorm());
    }
    sum += std::sqrt(nearest_squared);
  }
  return sum / static_cast<double>(surface_points_.size());
}

double PartGeometry::mssd_mm(const Pose& estimate, const Pose& truth) const {
  double best_squared = 1e300;
  for (const Pose& s : all_symmetries_) {
    const Pose turned = truth * s;
    double worst_squared = 0;
    for (const Vec3& p : outer_points_) {
      worst_squared = std::max(worst_squared, (turned * p - estimate * p).squaredNorm());
      if (worst_squared >= best_squared) break;
    }
    best_squared = std::min(best_squared, worst_squared);
  }
  return std::sqrt(best_squared);
}

}  // namespace binpick::app
