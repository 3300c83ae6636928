// Who explains what the scene shows: each pixel belongs to the first pose that covered it. With
// depth a pose covers the measured pixels on which its surface lies, without it those that it
// projects to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "binpick/base/arena.hpp"
#include "pose/hypothesis.hpp"

namespace binpick {

class Coverage {
 public:
  // Width and height are of the depth level.
  static std::size_t footprint(int width_max, int height_max, int owners_max, int thread_count);
  Coverage(int width_max, int height_max, int owners_max, int thread_count, Arena& arena);

  void clear(const Scene& scene);
  struct Covered {
    double share = 0;             // of what `h` explains, by the owners so far
    Hypothesis* owner = nullptr;  // of most of it
  };
  // Each of the threads that ask at the same time has its own number.
  Covered covered(const PoseContext& context, const Hypothesis& h, int thread = 0) const;
  // The owner where it and others cover more than kCoveredShareMax; else null.
  Hypothesis* owner_of(const PoseContext& context, const Hypothesis& h, int thread = 0) const {
    const Covered found = covered(context, h, thread);
    return found.share > kCoveredShareMax ? found.owner : nullptr;
  }
  // `h` owns from now on what it explains and nobody owned, and has to stay where it is until
  // clear(). False where there is no room for another owner.
  bool add(const PoseContext& context, Hypothesis& h);

  std::span<Hypothesis* const> owners() const { return buffers_.owners.first(owner_count_); }

 private:
  template <class Visit>
  void visit_cells(const PoseContext& context, const Hypothesis& h, Visit&& visit) const;
  std::span<int> votes_of(int thread) const;

  struct Buffers {
    std::span<std::uint16_t> cells;  // 1 + the owner; 0: nobody's
    std::span<int> votes;            // of each thread: samples on cells of each owner
    std::span<Hypothesis*> owners;
  };
  // The one list of what a coverage takes, from an Arena or an ArenaPlan.
  template <class Source>
  static Buffers take(int width_max, int height_max, int owners_max, int thread_count,
                      Source& source);

  Buffers buffers_;
  std::size_t owner_count_ = 0;
  int columns_ = 0, rows_ = 0;
};

}  // namespace binpick
