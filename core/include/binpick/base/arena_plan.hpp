// Stands in for an Arena to count what a part would take: a part lists its buffers once, in a
// function that works with either.
#pragma once

#include "binpick/base/arena.hpp"

namespace binpick {

struct ArenaPlan {
  std::size_t bytes = 0;

  template <class T>
  std::span<T> take(std::size_t count) {
    bytes += Arena::padded(count * sizeof(T));
    return {};
  }
};

}  // namespace binpick
