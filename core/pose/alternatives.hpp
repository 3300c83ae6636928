// Pose ambiguity: other poses that look like the one found, which a search need not have found.
// Near-symmetric parts may be taken for themselves turned (a plate turned over, a ring whose notch
// alone tells its roll). Slippable surfaces (a pipe's end, a flange) stay on themselves while the
// part turns about their axis (Gelfand and Guibas, Shape segmentation using local slippage
// analysis, SGP 2004). Each alternative goes through alignment and verification like any other
// hypothesis, and competes with the pose it comes from.
#pragma once

#include <optional>
#include <span>

#include "pose/hypothesis.hpp"

namespace binpick {

// A line, camera coordinates.
struct RotationAxis {
  Vec3 point_mm, direction;
};
// The axis about which the part can rotate while the surface that the pose explains hardly moves
// along its normals. Nothing where every rotation would show in the depth.
std::optional<RotationAxis> slippage_axis(const ObjectModel& model, const Scene& scene,
                                          const Pose& T_cam_centre);

// Appends the alternatives of the local best among the first `count` of the list, verified but not
// aligned; of a rotation's many angles the most probable. Returns how many there are now; what is
// beyond the list's end is left out. What the deadline cuts is dropped.
std::size_t add_alternatives(const PoseContext& context, std::span<Hypothesis> list,
                             std::size_t count);

}  // namespace binpick
