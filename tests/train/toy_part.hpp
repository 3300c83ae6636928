// Small parts made of boxes, and the options to train them in a moment.
#pragma once

#include <random>

#include "binpick/train/mesh.hpp"
#include "binpick/train/trainer.hpp"

namespace binpick::train {

// Uniform in [low, high) from the bits of the engine alone, so that every library draws the same.
inline double uniform(std::mt19937_64& engine, double low, double high) {
  return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1.0p-53;
}

// The eight corners as min + fractions of the extent; the upper face may be shifted and shrunk in
// x.
inline void add_block(Mesh& mesh, const Vec3& min_mm, const Vec3& max_mm, double top_shrink = 0) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_mm.size());
  for (int i = 0; i < 8; ++i) {
    Vec3 v((i & 1) ? max_mm.x() : min_mm.x(), (i & 2) ? max_mm.y() : min_mm.y(),
           (i & 4) ? max_mm.z() : min_mm.z());
    if ((i & 5) == 5) v.x() -= top_shrink * (max_mm.x() - min_mm.x());
    mesh.vertices_mm.push_back(v.cast<float>());
  }
  for (const auto& t : {std::array<std::uint32_t, 3>{0, 2, 1},
                        {1, 2, 3},
                        {4, 5, 6},
                        {5, 7, 6},
                        {0, 1, 4},
                        {1, 5, 4},
                        {2, 6, 3},
                        {3, 6, 7},
                        {0, 4, 2},
                        {2, 4, 6},
                        {1, 3, 5},
                        {3, 7, 5}}) {
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

inline Mesh box_part(const Vec3& half_mm, const Vec3& centre_mm = Vec3::Zero()) {
  Mesh mesh;
  add_block(mesh, centre_mm - half_mm, centre_mm + half_mm);
  return mesh;
}

// A plate with a wedge, a tower and a fin: no two views of it are alike.
inline Mesh asymmetric_part() {
  Mesh mesh;
  add_block(mesh, {-32, -20, -9}, {32, 20, -1});
  add_block(mesh, {-32, -20, -1}, {0, 6, 14}, 0.7);
  add_block(mesh, {12, 4, -1}, {24, 16, 21});
  add_block(mesh, {4, -20, -1}, {32, -15, 9});
  return mesh;
}

// A camera of 1280x1024 whose template of a part of 80 mm is about 80 px wide.
inline TrainOptions toy_options() {
  TrainOptions options;
  options.camera = {1280, 1024, 1200, 1200, 640, 512};
  options.distance_min_mm = 500;
  options.distance_max_mm = 700;
  return options;
}

// Enough to see every stage of training at work.
inline TrainOptions small_options() {
  TrainOptions options = toy_options();
  options.tree_depths = 2;
  options.tilt_max_deg = 22;  // seven leaves: one from above, six from beside it
  options.roll_interval_deg = 30;
  options.samples = 30;
  return options;
}

inline ImportedMesh imported(Mesh mesh) {
  ImportedMesh part;
  part.mesh = std::move(mesh);
  part.source_hash = 42;
  return part;
}

}  // namespace binpick::train
