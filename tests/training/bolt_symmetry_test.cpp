#include <gtest/gtest.h>

#include <algorithm>

#include "binpick/train/mesh.hpp"
#include "parts.hpp"
#include "train/symmetry.hpp"

namespace binpick {
namespace {

// A sixth of a turn brings the head onto itself, but the thread only with a shift. What any roll
// changes, corners of the head and where the thread's flanks lie, is little.
TEST(BoltSymmetry, IsNoScrew) {
  train::Mesh mesh;
  const simulation::TriangleMesh bolt = simulation::make_bolt();
  for (const auto& v : bolt.vertices) mesh.vertices_mm.push_back(v.cast<float>());
  for (const auto& t : bolt.triangles) {
    mesh.triangles.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                              static_cast<std::uint32_t>(t[2])});
  }
  const double diameter_mm = train::mesh_bounds(mesh).diameter_mm;
  const train::FoundSymmetry found =
      train::find_symmetry(mesh, diameter_mm, train::symmetry_tolerance(diameter_mm, 1902, 670));
  ASSERT_EQ(found.axes.size(), 1u);
  EXPECT_EQ(found.axes[0].kind, SymmetryKind::kNear);
  EXPECT_GT(std::abs(found.axes[0].axis[2]), 0.9999f);
  EXPECT_TRUE(std::none_of(found.turns.begin(), found.turns.end(), [](const SymmetryTurn& turn) {
    return turn.kind == SymmetryKind::kExact;
  }));
}

}  // namespace
}  // namespace binpick
