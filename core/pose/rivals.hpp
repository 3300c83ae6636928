// Poses that compete for the same pixels: at most one of them is right, so each is less probable
// the more probable the others are. Two ends of a pipe, of which the rest is hidden, fit as well at
// any turn about the end's axis; none of those poses is one to act on.
#pragma once

#include "pose/hypothesis.hpp"

namespace binpick {

// `rival` explains pixels that `owner` owns. It counts where it is another pose: what differs by
// less than parts are gripped by is the same again.
void meet_rival(const PoseContext& context, Hypothesis& owner, const Hypothesis& rival);
// The owner's score, once it has met all its rivals.
void score_beside_rivals(const PoseContext& context, Hypothesis& owner);

}  // namespace binpick
