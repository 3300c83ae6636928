// The balanced pose tree (paper section III-B): viewpoints, rolls and distances per depth, and who
// is whose child. A node is a (viewpoint, roll, distance); roll r at depth d has the children 2r
// and 2r+1, distance k has 2k and 2k+1.
#pragma once

#include <vector>

#include "binpick/geometry/pose.hpp"
#include "binpick/train/trainer.hpp"
#include "train/symmetry.hpp"

namespace binpick::train {

struct TreeViewpoint {
  Vec3 direction_obj;  // unit, from the object towards the camera
  Mat3 R_view_obj;     // camera axes at roll 0: carried over from the parent without twist, so that
                       // the rolls of parent and child mean the same
  int parent = -1;
  int child_first = 0;
  int child_count = 0;
};

struct TreeLayer {
  std::vector<TreeViewpoint> viewpoints;
  int roll_count = 0;
  int distance_count = 0;
};

struct PoseTree {
  std::vector<TreeLayer> depths;
  const TreeLayer& leaves() const { return depths.back(); }
};

// Viewpoints that an exact symmetry makes equal to others are left out, leaves first: a node has
// fewer children then, and is gone when it has none.
PoseTree make_pose_tree(const TrainOptions& options, const FoundSymmetry& symmetry = {});

// Centre of roll r of n, in rad.
double roll_centre_rad(int roll, int roll_count);

// Rotation about the optical axis by `angle`: turns the image from +x towards +y.
Mat3 rotation_z(double angle_rad);

}  // namespace binpick::train
