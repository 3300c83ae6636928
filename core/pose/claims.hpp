// Who owns what the scene shows: each pixel belongs to the first pose that claimed it.
#pragma once

#include <cstddef>
#include <span>

#include "binpick/base/arena.hpp"
#include "pose/explain.hpp"
#include "pose/hypothesis.hpp"

namespace binpick {

class Claims {
 public:
  // Width and height are of the depth level.
  static std::size_t footprint(int width_max, int height_max, int owners_max, int thread_count);
  Claims(int width_max, int height_max, int owners_max, int thread_count, Arena& arena);

  void clear(const Scene& scene);
  // Of most of what `h` explains, where more than kOwnedShareMax of that is owned; else null. Each
  // of the threads that ask at the same time has its own number.
  Hypothesis* owner_of(const PoseContext& context, const Hypothesis& h, int thread = 0) const;
  // `h` owns from now on what it explains and nobody owned, and has to stay where it is until
  // clear(). False where there is no room for another owner.
  bool add(const PoseContext& context, Hypothesis& h);

  std::span<Hypothesis* const> owners() const { return owners_.first(owner_count_); }

 private:
  SceneOwnership ownership_;
  std::span<Hypothesis*> owners_;
  std::size_t owner_count_ = 0;
};

}  // namespace binpick
