#include "binpick/report/detection.hpp"

namespace binpick {

const char* drop_reason_name(DropReason reason) {
  switch (reason) {
    case DropReason::kBelowMatchThreshold:
      return "below_match_threshold";
    case DropReason::kLevelLimit:
      return "level_limit";
    case DropReason::kDuplicate:
      return "duplicate";
    case DropReason::kPoseDiverged:
      return "pose_diverged";
    case DropReason::kTooHidden:
      return "too_hidden";
    case DropReason::kContradicted:
      return "contradicted";
    case DropReason::kBelowMinScore:
      return "below_min_score";
    case DropReason::kOverlapsBetter:
      return "overlaps_better";
    case DropReason::kResultLimit:
      return "result_limit";
    case DropReason::kDeadline:
      return "deadline";
  }
  return "unknown";
}

const char* stage_name(Stage stage) {
  switch (stage) {
    case Stage::kPyramid:
      return "pyramid";
    case Stage::kScan:
      return "scan";
    case Stage::kDescend:
      return "descend";
    case Stage::kScore:
      return "score";
    case Stage::kAlign:
      return "align";
    case Stage::kVerify:
      return "verify";
    case Stage::kSelect:
      return "select";
    case Stage::kAlternatives:
      return "alternatives";
  }
  return "unknown";
}

const char* score_term_name(ScoreTerm term) {
  switch (term) {
    case ScoreTerm::kDepthSupport:
      return "depth_support";
    case ScoreTerm::kContourSupport:
      return "contour_support";
    case ScoreTerm::kMeasured:
      return "measured";
    case ScoreTerm::kSupportedArea:
      return "supported_area";
    case ScoreTerm::kContradicted:
      return "contradicted";
    case ScoreTerm::kHidden:
      return "hidden";
    case ScoreTerm::kOutlineSteps:
      return "outline_steps";
    case ScoreTerm::kOutlineBare:
      return "outline_bare";
    case ScoreTerm::kOutlineOffset:
      return "outline_offset";
    case ScoreTerm::kCreases:
      return "creases";
    case ScoreTerm::kTemplate:
      return "template";
    case ScoreTerm::kConflicts:
      return "conflicts";
  }
  return "unknown";
}

}  // namespace binpick
