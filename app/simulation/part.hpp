// A part as the simulation sees it: shape, looks, and which of its poses cannot be told apart.
#pragma once

#include <string>
#include <vector>

#include "binpick/geometry/pose.hpp"
#include "simulation/triangle_mesh.hpp"

namespace binpick::simulation {

// What a surface looks like; bench and bin are finishes too.
enum class Finish {
  kCastBrass,
  kGalvanised,
  kMachined,
  kPolished,
  kPlastic,
  kRubber,
  kBench,
  kBin
};
// Metals send light away from where it came from, and to each other.
constexpr bool is_metal(Finish finish) {
  return finish <= Finish::kPolished;
}

struct Part {
  int obj_id = 0;
  std::string name;
  TriangleMesh mesh;             // mm
  std::vector<Pose> symmetries;  // without the identity
  // Symmetry about an axis through the origin, as in models_info.json; empty when there is none.
  std::vector<Vec3> symmetry_axes;
  Finish finish = Finish::kMachined;
};

}  // namespace binpick::simulation
