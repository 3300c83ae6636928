// A pose on its way from a matched template to a detection.
#pragma once

#include <optional>
#include <span>

#include "base/deadline.hpp"
#include "binpick/base/worker_pool.hpp"
#include "binpick/report/detection.hpp"
#include "pose/part_moves.hpp"
#include "pose/scene.hpp"
#include "pose/verify.hpp"
#include "search/candidate.hpp"

namespace binpick {

struct Hypothesis {
  Candidate candidate;
  Pose T_cam_centre;
  Evidence evidence;
  double score = 0;       // probability that the pose is right, once it is verified
  double rank = 0;        // what the list is ordered by
  double rival_odds = 0;  // of the other poses that explain the same pixels, once explained
  bool leads = false;     // the best at its place, after suppress()
  bool alive = true;
  DropReason drop_reason = DropReason::kDuplicate;  // where not alive

  void drop(DropReason reason) {
    alive = false;
    drop_reason = reason;
  }
};

ScoreTerms terms_of(const Hypothesis& h);
// Living before dropped, then by rank; a total order.
bool better_hypothesis(const Hypothesis& a, const Hypothesis& b);
void count_drop(DetectionReport& report, DropReason reason);

// Each stage works on every living hypothesis on its own.
struct PoseContext {
  std::span<const ObjectModel> models;
  std::span<const PartMoves> moves;  // of each model
  const Scene& scene;
  WorkerPool& pool;
  Deadline deadline;  // of the stage: hypotheses that it does not reach are dropped
};

// What a list of better hypotheses has near another one. Without depth a difference in distance
// that hardly shows does not count.
struct Neighbours {
  bool repeated = false;  // its pose, or one that an exact symmetry makes equal to it
  int at_place = 0;       // that compete for the same part; not counted to the end where repeated
};

// Whether two hypotheses of a model compete for the same part.
bool at_one_place(const PoseContext& context, const Hypothesis& a, const Hypothesis& b);

// How near poses are the same.
struct SameLimits {
  double diameters, angle_rad;
};
// Whether two poses of a model are the same for whoever grips the part.
bool same_pick(const PoseContext& context, int model_index, const Pose& a, const Pose& b);
Neighbours neighbours_of(const PoseContext& context, std::span<const Hypothesis> better,
                         const Hypothesis& h, const SameLimits& same);

// Without depth PnP finds the distance too, and nothing is left for ICP.
void run_pnp(const PoseContext& context, std::span<Hypothesis> hypotheses);
void run_icp(const PoseContext& context, std::span<Hypothesis> hypotheses);
void run_refine(const PoseContext& context, std::span<Hypothesis> hypotheses);
void run_verify(const PoseContext& context, std::span<Hypothesis> hypotheses);

// The last two for a single pose. False where refinement lost it.
bool refine_pose(const PoseContext& context, const ObjectModel& model, Pose& T_cam_centre);
void verify_pose(const PoseContext& context, Hypothesis& h);

// Sorts by evidence, best first, drops those whose pose repeats a better one, keeps at most
// per_place around each place, and moves the living ones to the front. Returns how many live;
// counts the drops.
int suppress(const PoseContext& context, std::span<Hypothesis> hypotheses, int per_place,
             DetectionReport& report);

}  // namespace binpick
