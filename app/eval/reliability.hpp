// Whether the score is what it says: a probability that the pose is right. Poses are put into bins
// by their score; in each the mean of the scores ought to be the share of the poses that are right.
//
// Right is a pose within the limits of any part that is there, however little of it shows: the
// score tells nothing of whether a part has to be found. Each part is taken once, by the most
// probable pose, so a repeated pose is wrong.
#pragma once

#include <string>
#include <vector>

#include "eval/score.hpp"

namespace binpick::app {

struct JudgedPose {
  double probability = 0;
  bool right = false;
};

// How many poses are right, and between what their share may lie: Wilson's interval, 95 %.
struct RightShare {
  int count = 0, right = 0;

  double share() const { return count > 0 ? static_cast<double>(right) / count : 0; }
  double low() const;
  double high() const;
};

struct ReliabilityBin {
  double from = 0, to = 0;  // of the probability; the last bin has its end too
  double probability = 0;   // mean
  RightShare seen;
};

struct Reliability {
  std::string name;                  // of the part
  std::vector<ReliabilityBin> bins;  // ascending, those without a pose included
  int count = 0;
  double calibration_error = 0;  // expected: mean over the poses of |probability - share| of bins
  double threshold = 0;
  RightShare accepted;  // of the poses at the threshold and above
};

Reliability reliability_of(const std::vector<JudgedPose>& poses, double threshold);

// The poses of a part, judged as above by the marks of the scoring.
std::vector<JudgedPose> judged_poses(const PartScore& part, const std::vector<ResultRow>& rows);

// Of each part and kind of a mixed scene, then of all poses together; nothing where there are none.
std::vector<Reliability> find_reliability(const ScoreReport& report,
                                          const std::vector<ResultRow>& rows, double threshold);

}  // namespace binpick::app
