// How near a candidate or a hypothesis is to a pose that is known to be right.
#pragma once

#include "binpick/diagnosis/diagnosis.hpp"
#include "pose/hypothesis.hpp"

namespace binpick {

// `T_cam_centre` against the nearest of the reference's poses: the largest of the six errors in
// units of its limit.
double reference_error(const ObjectModel& model, const ReferencePose& reference,
                       const Pose& T_cam_centre, double position_mm, double angle_rad);

// Rotations nearer than this share a node of the tree at a depth, or are neighbours in it.
double node_radius_rad(const ObjectModel& model, int depth);

// Whether a candidate of some depth is where a search for the reference should pass: within a few
// pixels of its level and the spacing of the tree.
class NearCandidate {
 public:
  NearCandidate(const ObjectModel& model, const ReferencePose& reference, int depth,
                const FeaturePyramid& pyramid);
  bool operator()(const Candidate& c) const;

 private:
  const ObjectModel& model_;
  const ReferencePose& reference_;
  const FeaturePyramid& pyramid_;
  int depth_;
  double radius_rad_;
  Vec2 pixel_;        // of the reference's centre, level 0
  double spread_px_;  // by which the centres of poses that look alike differ
};

}  // namespace binpick
