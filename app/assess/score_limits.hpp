// Why parts get low scores: which terms of the score cost most, and what can be done about it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "binpick/frame/modality.hpp"
#include "binpick/model/model_trials.hpp"
#include "binpick/report/detection.hpp"

namespace binpick::app {

enum class ScoreLimit : int {
  kHidden = 0,    // by other parts
  kMissingDepth,  // on the part
  kSmall,         // few pixels
  kOffSurface,    // the depth does not lie on the CAD's surface
  kOutline,       // little of it on image or depth edges
  kOffset,        // image edges beside the outline
  kBehind,        // depth behind the CAD's surface
  kConflicts,     // other poses explain the same pixels
  kCalibration,   // even without all of the above the score would be low
  kSearch,        // no low score: in some frames it is not found at all
};
inline constexpr int kScoreLimitCount = 10;
const char* score_limit_name(ScoreLimit limit);  // snake_case, as written to JSON

// What was seen of one part, as means over its poses below the threshold.
struct PartEvidence {
  int number = 0;   // of the part, for people
  bool low = true;  // false: there are none, though frames in which it is not found
  ScoreTerms terms{};
  double missing_share = 0, residual_mm = 0;
};

// What holds for all parts of one kind.
struct LimitContext {
  Modality seen = Modality::kDepthAndIntensity;
  ModelTrials trials;
  ScoreTerms best{};     // as good as each term gets
  double noise_mm = 0;   // of the depth from frame to frame; 0: not known
  double threshold = 0;  // that the parts fall short of
};

// The best values: those that stand for nothing amiss, and where that depends on the part (its
// size, its creases, its templates) what a tenth of the poses reach.
ScoreTerms best_terms(std::span<const ScoreTerms> poses);

// What each term costs: how much the log odds would rise with its best value.
ScoreTerms score_costs(const ScoreTerms& terms, const LimitContext& context);

struct LimitFinding {
  ScoreLimit limit;
  std::vector<int> parts;  // their numbers
  double cost = 0;         // log odds, mean over these parts
  std::string text;        // what it is, with its figures, and what to do
};

// The costliest one or two of each part, the finding with most parts first, of those with as many
// the costliest.
std::vector<LimitFinding> find_limits(std::span<const PartEvidence> parts,
                                      const LimitContext& context);

}  // namespace binpick::app
