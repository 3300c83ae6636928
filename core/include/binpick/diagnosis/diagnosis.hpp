// Where a detector loses a part that is known to be there, and what it makes of the part when it
// need not search. For evaluation: the answer of the detection is what detect() answers, the known
// poses only look on. Slower, and allocates.
#pragma once

#include <array>
#include <span>

#include "binpick/detect/checkpoint.hpp"
#include "binpick/detect/detector.hpp"

namespace binpick {

// What counts as the known pose: each of the six parameters (mm; components of the rotation vector
// between the two) within these. Earlier stages have wider limits of their own: those of the tree's
// spacing, and twice these.
struct ReferenceLimits {
  double position_mm = 5;
  double angle_rad = 0.1308996938995747;  // 7.5 degrees
};

struct ReferencePose {
  int model_index = 0;
  // T_cam_obj of all poses that look alike; the first is the one that is started from.
  std::span<const Pose> poses;
};

// The best ranked of the poses near the known one at a checkpoint.
struct Sighting {
  int place = -1;  // in the list, best first; -1: nothing near
  int count = -1;  // of the list; -1: the checkpoint was not passed
  bool seen() const { return place >= 0; }
  bool passed() const { return count >= 0; }
};

// What becomes of a pose that is handed to the last stages instead of being searched for.
struct OracleStart {
  bool posed = false;          // it came through the alignment
  double error = 1e9;          // the largest of the six in units of its limit; below 1: right
  bool objected = false;       // its own evidence is too weak to be reported
  DropReason objection{};      // where objected
  double rank = 0;             // what it explains times its probability
  double owned_by_better = 0;  // share of what it explains that accepted poses of higher rank,
                               // the known one's own left out, explain too
  bool outranked = false;      // too much of it
  Detection detection;         // where posed

  bool right() const { return posed && error < 1; }
  bool reported() const { return posed && !objected && !outranked; }
};

struct ReferenceFinding {
  std::array<Sighting, kCheckpointCount> sightings{};
  // Of the hypothesis near the known pose that came last to the explanation of the scene.
  DropReason last_drop{};  // where it was seen at kFineSelected and not at kAccepted
  double last_score = 0;   // its probability
  // Scores of the template nearest to the known pose, at it, by tree depth; -1: not searched.
  std::array<double, kModelDepthsMax> template_scores{-1, -1, -1, -1};
  OracleStart from_truth;     // fine alignment and verification
  OracleStart from_template;  // the nearest leaf, then all pose steps
  // Another pose, accepted, that owns most of the pixels of the known one.
  bool has_owner = false;
  Detection owner;
  double owner_rank = 0;
  double owner_share = 0;  // of what the known pose explains
};

// detect(), and one finding for each reference. References to models that are not asked for stay as
// they are. `findings` has the size of `references`.
Result<DetectionReport> diagnose(Detector& detector, const Frame& frame,
                                 const DetectRequest& request,
                                 std::span<const ReferencePose> references,
                                 const ReferenceLimits& limits,
                                 std::span<ReferenceFinding> findings);

}  // namespace binpick
