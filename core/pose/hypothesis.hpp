// A pose on its way from a matched template to a detection.
#pragma once

#include <array>
#include <span>

#include "base/deadline.hpp"
#include "binpick/base/worker_pool.hpp"
#include "binpick/report/detection.hpp"
#include "pose/align.hpp"
#include "pose/scene.hpp"
#include "pose/symmetry_transforms.hpp"
#include "pose/verify.hpp"
#include "search/candidate.hpp"

namespace binpick {

struct Hypothesis;

// Other poses of a part that look the same as one, which detection cannot tell from it.
struct PoseAmbiguity {
  double odds = 0;                                             // of all of them, by the evidence
  std::array<const Hypothesis*, kPoseAlternativesMax> best{};  // the most probable first
};

struct Hypothesis {
  Candidate candidate;
  Pose T_cam_centre;
  Evidence evidence;
  // Probability that the pose is right, once it is verified: as fitted for all parts, which decides
  // what survives; of what is reported, with the calibration of its part.
  double score = 0;
  double rank = 0;             // what hypotheses are ordered by
  double conflict_odds = 0;    // sum over the other poses that explain the same pixels
  PoseAmbiguity ambiguity;     // of those that look the same
  bool is_local_best = false;  // the best at its place, after non-maximum suppression
  bool alive = true;
  DropReason drop_reason = DropReason::kDuplicate;  // where not alive

  void drop(DropReason reason) {
    alive = false;
    drop_reason = reason;
  }
};

// Living before dropped, then by rank; a total order.
bool better_hypothesis(const Hypothesis& a, const Hypothesis& b);
void count_drop(DetectionReport& report, DropReason reason);

// Each step works on every living hypothesis on its own.
struct PoseContext {
  std::span<const ObjectModel> models;
  std::span<const SymmetryTransforms> symmetries;  // of each model
  const Scene& scene;
  WorkerPool& pool;
  Deadline deadline;  // of the step: hypotheses that it does not reach are dropped
  NearSymmetry near_symmetry = NearSymmetry::kAuto;
};

ScoreTerms terms_of(const Hypothesis& h);
double log_odds_of(const Hypothesis& h);
// By its own evidence, whatever else explains its pixels.
double odds_alone(const Hypothesis& h);
// With the conflicts that are known by now.
double score_of(const PoseContext& context, const Hypothesis& h);

void align_all(const PoseContext& context, std::span<const AlignStep> schedule,
               std::span<Hypothesis> hypotheses);
void verify_all(const PoseContext& context, std::span<Hypothesis> hypotheses);

// The same for one.
void align_one(const PoseContext& context, std::span<const AlignStep> schedule, Hypothesis& h);
void verify_one(const PoseContext& context, Hypothesis& h);

}  // namespace binpick
