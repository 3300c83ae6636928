// What one detection run answers: poses with their evidence, and an account of everything dropped.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "binpick/geometry/pose.hpp"
#include "binpick/report/pose_uncertainty.hpp"

namespace binpick {

// What the score is made of; see core/pose/score.hpp. The order is that of the weights.
enum class ScoreTerm : int {
  kDepthSupport = 0,  // log of: share of the measured surface that lies where the model's is
  kContourSupport,    // log of: share of the visible outline on an image or depth edge
  kMeasured,          // log of: share of the visible surface with a measurement, 1 from 35 % on
  kSupportedArea,     // log of: pixels of the image that the pose explains
  kContradicted,      // share of the visible surface with something measured behind it
  kHidden,            // share of it with something in front
  kOutlineSteps,      // share of the visible outline on a depth step of its direction
  kOutlineBare,       // without depth: share of it with no edge beside it; else 0
  kOutlineOffset,     // px from the outline to the image edges beside it, on average
  kCreases,           // share of the visible creases on an image edge
  kTemplate,          // score of the matched template, 0..2; without depth 0..1
  kConflicts,         // log of: odds of the pose and of the others that explain the same pixels,
                      // over its own; 0 where there are no others
};
inline constexpr int kScoreTermCount = 12;
const char* score_term_name(ScoreTerm term);  // snake_case, as written to CSV
using ScoreTerms = std::array<double, kScoreTermCount>;

// Another pose that the part may have where its appearance does not tell.
struct PoseAlternative {
  Pose T_cam_obj;
  double probability = 0;  // given that it is this pose or one of its alternatives
};
inline constexpr std::size_t kPoseAlternativesMax = 3;

// One accepted pose.
struct Detection {
  int model_index = 0;          // index into the models the detector was made with
  Pose T_cam_obj;               // object to camera, mm
  double score = 0;             // probability that the pose is right, in [0, 1], up to moves that
                                // the part's appearance does not tell (SymmetryKind)
  bool symmetric = false;       // the part looks the same in other poses
  double pose_probability = 1;  // of this one among the poses that detection cannot tell apart
  int alternative_count = 0;    // the others of them, the most probable first
  std::array<PoseAlternative, kPoseAlternativesMax> alternatives{};
  double visible_fraction = 0;   // share of the model's visible surface that the scene does not
                                 // hide; 1 without depth, which alone could tell
  double depth_support = 0;      // of the visible surface with a measurement: share that agrees
  double contour_support = 0;    // share of the visible contour that lies on an image or depth edge
  double depth_residual_mm = 0;  // median |point-to-plane residual| over the supported surface
  double template_score = 0;  // sum of the modalities' scores at the matched leaf, each in [0, 1]
  int template_index = -1;    // the matched leaf of the pose tree
  ScoreTerms score_terms{};
  PoseUncertainty uncertainty;
};

// A pose that is less probable than this among its alternatives is ambiguous.
inline constexpr double kPoseAmbiguousBelow = 0.8;
inline bool pose_ambiguous(const Detection& d) {
  return d.pose_probability < kPoseAmbiguousBelow;
}

// Measured pixels (without depth: pixels) that a better detection explains already: beyond this
// share it is the same part again.
inline constexpr double kCoveredShareMax = 0.35;

// Why a candidate did not become a detection.
enum class DropReason : int {
  kBelowMatchThreshold = 0,  // template score too low at its level
  kLevelLimit,               // more candidates than the level's limit; the lowest scores went
  kDuplicate,                // the same pose as a better candidate
  kPoseDiverged,             // refinement left its basin or lost its support
  kTooHidden,                // too little of the part can be seen
  kContradicted,             // measured surface lies behind the model's: free space violated
  kBelowMinScore,            // verification score under the requested minimum
  kOverlapsBetter,           // its pixels belong to a better detection
  kResultLimit,              // more detections than asked for
  kDeadline,                 // the time was up; the least promising went first
};
inline constexpr int kDropReasonCount = 10;
const char* drop_reason_name(DropReason reason);  // snake_case, as written to JSON

// The steps of a detection, as ARCHITECTURE.md lists them.
enum class Stage : int {
  kPyramid = 0,
  kScan,
  kDescend,
  kScore,
  kAlign,
  kVerify,
  kSelect,
  kAlternatives
};
inline constexpr int kStageCount = 8;
const char* stage_name(Stage stage);

inline constexpr int kTreeLevelsMax = 5;

// What came nearest to a detection where there is none.
struct RejectedPose {
  Detection pose;
  DropReason reason = DropReason::kBelowMinScore;
};

struct DetectionReport {
  std::span<const Detection> detections;      // best score first; valid until the next detect()
  std::optional<RejectedPose> best_rejected;  // only where there are none
  std::array<double, kStageCount> stage_ms{};
  double total_ms = 0;
  bool cut_short = false;  // the deadline came before all was searched and verified
  int level_count = 0;     // depths of the deepest tree that was searched
  std::array<int, kTreeLevelsMax> candidates{};  // kept at tree depth d, all models
  std::array<std::int64_t, kTreeLevelsMax>
      templates_evaluated{};                      // template x block matches at depth d
  std::array<double, kTreeLevelsMax> level_ms{};  // time of matching at depth d, selection left out
  std::array<int, kDropReasonCount> dropped{};
};

}  // namespace binpick
