// The last question to a pose: is it the part, or what the part may be taken for? A plate that can
// be turned over, a ring whose notch alone tells its roll: what the stages before agree with comes
// from surface that both have, and noise decides. Here each near-symmetric variant is tried where
// it differs.
#pragma once

#include "pose/hypothesis.hpp"

namespace binpick {

struct SettleOutcome {
  bool changed = false;    // a pose: they have to be suppressed anew
  bool cut_short = false;  // the deadline came before all were settled
};

// For the best hypothesis of each place: the near-symmetric variants are compared with it, the most
// promising ones refined and verified, and the winner takes its place. `hypotheses` are sorted as
// suppress() leaves them.
SettleOutcome settle_near_poses(const PoseContext& context, std::span<Hypothesis> hypotheses);

}  // namespace binpick
