// The account of an evaluation's faults: every missed part and every wrong detection with its
// cause, and for each part what could be reached.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "eval/false_pick.hpp"
#include "eval/loss.hpp"

namespace binpick::app {

struct MissedPart {
  const TargetFinding* target = nullptr;
  LossCause cause;
  double visible_fraction = 1;
};

// Of one part, at its best threshold. Begun at the truth or at the nearest template, every part is
// there to be reported; what the run reported wrongly stays, but for poses whose place those take.
struct PartFaults {
  std::string name;  // "obj 1", "scene 7, obj 1"
  int obj_id = 0;
  double threshold = 0;
  int targets = 0;
  int found = 0;  // by the run
  ThresholdScore run;
  ThresholdScore from_truth;  // at thresholds of their own
  ThresholdScore from_template;
  std::array<int, kLossCount> lost{};
  std::array<int, kFalsePickKindCount> false_picks{};
  std::vector<MissedPart> missed;
  std::vector<FalsePick> wrong;
};

// In the order of the report's parts, mixed ones last. Points into `targets`.
std::vector<PartFaults> analyse_faults(const ScoreReport& score, const TruthByFrame& truth,
                                       const std::map<int, PartGeometry>& geometry,
                                       const std::vector<ResultRow>& rows,
                                       const std::vector<TargetFinding>& targets);

}  // namespace binpick::app
