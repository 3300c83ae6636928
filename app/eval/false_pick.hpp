// What a wrong detection is: the part that stands there in another pose, the same part again, or no
// part at all.
#pragma once

#include <string>

#include "eval/score.hpp"

namespace binpick::app {

enum class FalsePickKind : int {
  kRepeated = 0,  // right, but the part was reported before
  kSlid,          // turned right, beside its place
  kTurned,        // in its place, turned by less than 60 degrees
  kFlipped,       // in its place, turned by more
  kAdrift,        // near a part, turned and beside its place
  kClutter,       // no part is near
};
inline constexpr int kFalsePickKindCount = 6;
const char* false_pick_name(FalsePickKind kind);  // one lower-case word

struct FalsePick {
  std::size_t row_index = 0;
  FalsePickKind kind = FalsePickKind::kClutter;
  int instance = -1;                  // of the frame's truth, the one it is most like; -1: clutter
  double shift_mm = 0, turn_deg = 0;  // from that
};

// `instances`: the frame's truth.
FalsePick classify_false_pick(const PartGeometry& part, int obj_id, const Pose& estimate,
                              const std::vector<ScoredInstance>& instances,
                              const PoseLimits& limits);

// "turned: 1.2 mm and 30 deg from a part that is 83 % visible".
std::string false_pick_text(const FalsePick& pick, const std::vector<ScoredInstance>& instances);

}  // namespace binpick::app
