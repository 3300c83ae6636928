#include "binpick/detect/checkpoint.hpp"

#include <cstddef>

namespace binpick {

const char* checkpoint_name(Checkpoint checkpoint) {
  static constexpr const char* kNames[kCheckpointCount] = {
      "scanned",        "scan_selected",   "descended_1",  "selected_1",    "descended_2",
      "selected_2",     "descended_3",     "selected_3",   "scored",        "score_selected",
      "aligned_coarse", "coarse_selected", "aligned_fine", "fine_selected", "accepted"};
  return kNames[static_cast<std::size_t>(checkpoint)];
}

}  // namespace binpick
