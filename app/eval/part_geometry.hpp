// How far an estimated pose is from a true one, for a part that may look the same from several
// sides: the six signed parameters of the bin-picking experiment, ADD and ADD-S, and MSSD.
// Thread-safe: immutable.
#pragma once

#include <array>
#include <vector>

#include "binpick/drivers/bop_dataset.hpp"
#include "binpick/train/mesh.hpp"

namespace binpick::app {

// x, y, z in mm, then the components of the rotation vector of R_est * R_true^T in degrees.
using PoseError6 = std::array<double, 6>;

struct PoseLimits {
  double mm = 5.0;
  double deg = 7.5;
};

// The largest of the six errors in units of its limit; below 1 the pose counts as right.
double relative_error(const PoseError6& error, const PoseLimits& limits);

class PartGeometry {
 public:
  PartGeometry(const drivers::BopModel& model, const train::Mesh& mesh);

  double diameter_mm() const { return diameter_mm_; }
  bool symmetric() const { return discrete_.size() > 1 || !continuous_.empty(); }
  // Object to object, the identity among them; continuous ones every two degrees.
  const std::vector<Pose>& symmetries() const { return all_symmetries_; }

  // Against the best of the part's symmetric poses.
  PoseError6 six_errors(const Pose& estimate, const Pose& truth, const PoseLimits& limits) const;

  // Mean distance of corresponding surface points (ADD), or of nearest ones where the part has a
  // symmetry (ADD-S).
  double add_mm(const Pose& estimate, const Pose& truth) const;

  // Largest distance of corresponding vertices under the best symmetry.
  double mssd_mm(const Pose& estimate, const Pose& truth) const;

 private:
  double diameter_mm_ = 0;
  std::vector<Pose> discrete_;  // the identity first
  std::vector<drivers::ContinuousSymmetry> continuous_;
  std::vector<Pose> all_symmetries_;  // continuous ones sampled every two degrees
  std::vector<Vec3> surface_points_;
  std::vector<Vec3> outer_points_;  // a largest distance is reached at one of these
};

// `count` points on the surface, uniform by area, the same on every machine. The generator and the
// order of draws are those of numpy.random.default_rng(1) with choice() and random(), so that a
// script can work with the same points.
std::vector<Vec3> sample_surface(const train::Mesh& mesh, int count);

}  // namespace binpick::app
