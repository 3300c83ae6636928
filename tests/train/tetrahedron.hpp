// A closed solid of four faces, for the tests of meshes.
#pragma once

#include <iterator>

#include "binpick/train/mesh.hpp"

namespace binpick::train {

inline const Eigen::Vector3f kCorners[] = {{0, 0, 0}, {30, 0, 0}, {0, 40, 0}, {0, 0, 10}};
inline constexpr std::array<std::uint32_t, 3> kFaces[] = {
    {0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

inline Mesh tetrahedron() {
  return {{std::begin(kCorners), std::end(kCorners)}, {std::begin(kFaces), std::end(kFaces)}};
}

}  // namespace binpick::train
