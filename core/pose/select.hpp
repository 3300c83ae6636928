// Which hypotheses survive: the one place that decides. Duplicates go by non-maximum suppression;
// of those that explain the same pixels one at most is right, so a far less probable one is spared
// further work, and at the end the better one owns the pixels and the others count against it.
#pragma once

#include <optional>
#include <span>

#include "pose/coverage.hpp"
#include "pose/place_grid.hpp"

namespace binpick {

struct SuppressLimits {
  double same_diameters, same_angle_rad;  // poses nearer than both are one
  int per_place;        // hypotheses with their centres within a quarter of the diameter
  std::size_t by_rank;  // so many survive whatever their place
};
// Leaf candidates: half the spacing of the leaves. The last part of the room is for places that
// have few so far: to a part that shows well hundreds of neighbouring templates fit.
SuppressLimits limits_of_candidates(std::size_t room);
// Aligned poses.
SuppressLimits limits_of_aligned();
// Of those the duplicates alone: before verification the rank says little about a place.
SuppressLimits limits_of_duplicates();

struct SelectorLimits {
  int width_max = 0, height_max = 0;  // of the depth level
  int owners_max = 0;                 // poses that may own pixels: those of low scores own some too
  std::size_t candidates_max = 0;     // that are suppressed at once
  std::size_t hypotheses_max = 0;     // that survive
  int thread_count = 1;
};

class Selector {
 public:
  static std::size_t footprint(const SelectorLimits& limits);
  Selector(const SelectorLimits& limits, Arena& arena);

  // Non-maximum suppression in 6D: writes those that survive to `out`, best rank first, and returns
  // how many; counts what was dropped, before or here. `out` and `from` do not overlap.
  std::size_t suppress(const PoseContext& context, std::span<const Hypothesis> from,
                       const SuppressLimits& limits, std::span<Hypothesis> out,
                       DetectionReport& report);
  // The same, in place.
  std::size_t suppress(const PoseContext& context, std::span<Hypothesis> list,
                       const SuppressLimits& limits, DetectionReport& report);

  // Of verified hypotheses, best first, drops the hopeless, and those that explain the pixels of
  // one that is likelier than not and are far less probable: alignment does not make up for that.
  void prune(const PoseContext& context, std::span<Hypothesis> ranked);

  // Explains the scene with the living ones, best first: each survivor owns its pixels, and its
  // score counts the conflicts with the others that explain them too. Those are dropped, as is what
  // its own evidence objects to, and what scores below min_score. Returns the survivors.
  std::span<Hypothesis* const> explain(const PoseContext& context, std::span<Hypothesis> ranked,
                                       double min_score, DetectionReport& report);

 private:
  struct Buffers {
    std::span<std::uint32_t> order;
    std::span<Hypothesis> kept;
    std::span<Hypothesis*> accepted;
  };
  template <class Source>
  static Buffers take(const SelectorLimits& limits, Source& source);

  Coverage coverage_;
  PlaceGrid grid_;
  Buffers buffers_;
};

// What a pose's own evidence says against reporting it; nothing where it is good.
std::optional<DropReason> objection_to(const Hypothesis& h, double min_score);
// Counts a pose that explains the owner's pixels against the owner, unless it is the same pose for
// whoever grips the part. One that looks the same makes the owner ambiguous, not less right.
void add_conflict(const PoseContext& context, const Hypothesis& other, Hypothesis& owner);

}  // namespace binpick
