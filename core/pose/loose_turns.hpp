// Other poses that show the same visible surface. Of a pipe's end, a flange or a plate's corner the
// measured surface looks the same after a turn about its own axis, wherever the rest of the part
// goes: the depth leaves that motion loose (slippage: Gelfand and Guibas, Shape segmentation using
// local slippage analysis, SGP 2004). A search that finds one of these poses need not find the
// others, so they are tried explicitly.
#pragma once

#include <optional>
#include <span>

#include "pose/hypothesis.hpp"

namespace binpick {

// The line about which the part can turn while the surface that it explains hardly moves along its
// normals; camera coordinates.
struct LooseTurn {
  Vec3 point_mm, axis;
};
// Nothing where every turn would show in the depth.
std::optional<LooseTurn> loose_turn(const ObjectModel& model, const Scene& scene,
                                    const Pose& T_cam_centre);

// Tries the turns of the leading poses among the first `count` of the list, refines and verifies
// the most probable ones, and appends them to the list, where they compete. Returns how many there
// are now; what is beyond the list's end is left out.
int add_loose_turns(const PoseContext& context, std::span<Hypothesis> list, int count);

}  // namespace binpick
