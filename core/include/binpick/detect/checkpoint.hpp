// After which step of a detection the poses on their way can be looked at.
#pragma once

namespace binpick {

// A tree that begins deeper passes fewer descents.
enum class Checkpoint : int {
  kScanned = 0,   // the best viewpoints of each cell
  kScanSelected,  // within the limits of place, viewpoint and number
  kDescended1,
  kSelected1,
  kDescended2,
  kSelected2,
  kDescended3,
  kSelected3,
  kScored,         // turned to poses that stand on the measured surface
  kScoreSelected,  // without duplicates, within the limit of number
  kAlignedCoarse,
  kCoarseSelected,  // without duplicates and far less probable ones, a few a place
  kAlignedFine,
  kFineSelected,  // with alternatives, without duplicates
  kAccepted,      // became a detection
};
inline constexpr int kCheckpointCount = 15;
const char* checkpoint_name(Checkpoint checkpoint);  // snake_case

}  // namespace binpick
