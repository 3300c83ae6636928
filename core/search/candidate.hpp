// A place in the image and in the pose tree that still may hold a part.
#pragma once

#include <cstdint>

#include "simd/score_scale.hpp"

namespace binpick {

struct Candidate {
  std::int16_t x = 0, y = 0;  // first pixel of a 2x2 quad, both even, at the pyramid level of the
                              // candidate's tree depth
  std::int16_t viewpoint = 0, roll = 0, distance = 0;  // node of the tree, at that depth
  std::uint16_t score = 0;                             // best of the quad
  std::uint8_t model = 0;
  std::uint8_t level = 0;       // pyramid level
  std::uint8_t best_pixel = 0;  // which of the quad, row by row
  std::uint8_t origin = 0;      // viewpoint at which the scan found it

  // A total order, so that results never depend on how the work was split: better score first.
  friend bool operator<(const Candidate& a, const Candidate& b) {
    if (a.score != b.score) return a.score > b.score;
    if (a.model != b.model) return a.model < b.model;
    if (a.level != b.level) return a.level < b.level;
    if (a.y != b.y) return a.y < b.y;
    if (a.x != b.x) return a.x < b.x;
    if (a.viewpoint != b.viewpoint) return a.viewpoint < b.viewpoint;
    if (a.roll != b.roll) return a.roll < b.roll;
    return a.distance < b.distance;
  }
};

}  // namespace binpick
