// Spares work that cannot matter: of the poses that explain the same pixels one at most is right.
// Those that are set aside are dropped as kOverlapsBetter; the next suppress() counts them.
#pragma once

#include <span>

#include "pose/claims.hpp"
#include "pose/hypothesis.hpp"

namespace binpick {

// Moves the first at each place to the front, and returns how many these are. The hypotheses of a
// model come best first.
std::size_t leaders_to_front(const PoseContext& context, std::span<Hypothesis> hypotheses);

// Of `others`, which are not verified yet, those that explain the pixels of one of the verified
// ones that is as good as certain. Sorts `verified`.
void set_aside_explained(const PoseContext& context, Claims& claims, std::span<Hypothesis> verified,
                         std::span<Hypothesis> others);

// Of `ranked`, which are verified, best first, those that explain the pixels of one that is likely,
// and are far less probable.
void set_aside_outdone(const PoseContext& context, Claims& claims, std::span<Hypothesis> ranked);

}  // namespace binpick
