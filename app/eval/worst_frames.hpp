// Which frames of an evaluation went worst, and what to draw on them.
#pragma once

#include <vector>

#include "eval/part_library.hpp"
#include "eval/score.hpp"
#include "overlay/overlay.hpp"

namespace binpick::app {

// The faults of one part in one frame at the part's best threshold.
struct FrameOutcome {
  drivers::FrameId frame;
  const PartScore* part = nullptr;
  int right = 0, wrong = 0, missed = 0;
  std::vector<DetectionMark> marks;   // detections at or above the threshold
  std::vector<int> missed_instances;  // indices into the frame's truth
};

std::vector<FrameOutcome> frame_outcomes(const PartScore& part, const TruthByFrame& truth,
                                         const std::vector<ResultRow>& rows,
                                         const ScoreOptions& options);

// The worst frame of each part first, then the worst of the rest, `count_max` in all; frames
// without a fault are left out. Points into `report`.
std::vector<FrameOutcome> worst_frames(const ScoreReport& report, const TruthByFrame& truth,
                                       const std::vector<ResultRow>& rows, std::size_t count_max);

// Misses and false picks on top of right ones.
std::vector<OverlayItem> overlay_items(const FrameOutcome& outcome, const TruthByFrame& truth,
                                       const std::vector<ResultRow>& rows, const train::Mesh& mesh);

// "scene 1, image 3, obj 1: 12 right, 2 false picks, 1 missed".
std::string caption(const FrameOutcome& outcome);

}  // namespace binpick::app
