// Moves of a part under which it comes to lie on itself, wholly or for the larger part: proper
// rotations with whatever translation fits best, found by search, not by what the CAD file says.
// Immutable once made: thread-safe.
#pragma once

#include <vector>

#include "train/shell_points.hpp"

namespace binpick::train {

// How a move carries the part onto itself, measured both ways.
struct SelfFit {
  double differing_share = 1;  // of the visible surface: what does not come to lie on any
  double deviation_mm = 0;     // the largest distance from a moved point to the surface
};

// Surfaces that coincide face alike within 40 degrees: of a thread and a plain shaft, only the
// shape that a sensor shows counts. About an axis within 63 degrees: of a thread that turns, one
// flank comes to lie where the other was, 60 degrees apart.
inline constexpr double kAlikeCos = 0.766, kAlikeAboutAxisCos = 0.45;

class SelfMatcher {
 public:
  // `similar_mm`: surfaces nearer than this, and facing alike (`alike_cos`), coincide.
  SelfMatcher(const Mesh& mesh, double diameter_mm, double similar_mm);

  // Where to look: the best moves of a search over all rotations, best first, none near another
  // and none near the identity. Rough.
  std::vector<Pose> candidates() const;
  // The nearest best fit: robust point-to-plane, what does not coincide does not pull.
  Pose refined(const Pose& move) const;
  SelfFit fit(const Pose& move, double alike_cos = kAlikeCos) const;
  double differing_share(const Pose& move, double alike_cos = kAlikeCos) const;
  // The same of a few points, one way.
  double quick_differing_share(const Pose& move, double alike_cos = kAlikeCos) const;
  // Whether every visible point comes to lie within `tolerance_mm` of the surface, both ways.
  bool exact(const Pose& move, double tolerance_mm) const;

  const Vec3& middle_mm() const { return middle_mm_; }
  // Rows: directions in which the part has its faces, at right angles.
  const Mat3& frame() const { return frame_; }
  const std::vector<Vec3>& special_axes() const { return special_axes_; }
  double diameter_mm() const { return diameter_mm_; }

 private:
  void fill_field();
  void find_frame();
  double rough_score(const Mat3& R, const Vec3& t_mm) const;
  Pose best_shift(const Mat3& R, double& score) const;
  double differing(const Pose& move, std::size_t count, double alike_cos) const;

  MeshTree tree_;
  std::vector<ShellPoint> points_;
  double diameter_mm_, similar_mm_;
  Vec3 middle_mm_;  // centroid of the visible surface
  Mat3 frame_;
  std::vector<Vec3> special_axes_;  // about which a symmetry is likely
  Vec3 field_origin_mm_;
  double cell_mm_ = 0;
  int field_size_ = 0;
  std::vector<float> field_mm_;  // distance to the surface, at most kFieldReachShare * diameter
};

}  // namespace binpick::train
