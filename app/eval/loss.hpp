// Why a part that had to be found was not: one cause for each, from what the diagnosis saw.
#pragma once

#include <string>

#include "eval/oracle_run.hpp"

namespace binpick::app {

// Where several hold, what stops even a pose begun at the truth counts, for nothing that is done
// before could help: kTruth, kData, kVerification and kRanking are judged so first. The others, by
// which stage lost the last pose near the truth.
enum class Loss : int {
  kNone = 0,      // found
  kSearch,        // scan, descent, or their limits
  kSuppression,   // screened out, or too many better ones at its place
  kRefinement,    // the coarse or the fine alignment took it away
  kVerification,  // its evidence gave it too low a score
  kRanking,       // another pose explains its pixels, and more
  kData,          // what the sensor measured does not tell the pose
  kTruth,         // the measured depth fits another pose better than the one given as true
};
inline constexpr int kLossCount = 8;
const char* loss_name(Loss loss);  // one lower-case word, "found" for kNone

struct LossCause {
  Loss loss = Loss::kNone;
  std::string why;  // a sentence without a full stop
};

// `found`: a detection at or above `threshold` was assigned to it. A pose begun at the truth has to
// reach the lower of that and `threshold_from_truth`, the best one were all parts begun there.
LossCause cause_of(const TargetFinding& target, bool found, double threshold,
                   double threshold_from_truth);

}  // namespace binpick::app
