#include "pose/hypothesis.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "pose/contour_evidence.hpp"
#include "pose/contour_pose.hpp"
#include "pose/icp.hpp"
#include "pose/pnp.hpp"
#include "pose/refine.hpp"
#include "pose/score.hpp"

namespace binpick {
namespace {

// After refinement: closer than this is the same pose.
constexpr SameLimits kSameRefined{0.015, 2.5 * kDegree};
constexpr SameLimits kSamePick{0.05, 7.5 * kDegree};
// Hypotheses whose centres are this near compete for the same part.
constexpr double kSamePlaceShare = 0.25;
constexpr int kPnpRangePx = 6;
constexpr int kCorrespondencesMax = 160;

template <class Fn>
void for_living(const PoseContext& context, std::span<Hypothesis> hypotheses, Fn&& fn) {
  constexpr int kPerTask = 4;
  const int count = static_cast<int>(hypotheses.size());
  context.pool.parallel_for((count + kPerTask - 1) / kPerTask, [&](int task, int) {
    for (int i = task * kPerTask; i < std::min(count, (task + 1) * kPerTask); ++i) {
      Hypothesis& h = hypotheses[static_cast<std::size_t>(i)];
      if (!h.alive) continue;
      if (context.deadline.passed()) {
        h.drop(DropReason::kDeadline);
      } else {
        const ObjectModel& model = context.models[h.candidate.model];
        h.T_cam_centre = context.moves[h.candidate.model].canonical(model, h.T_cam_centre);
        fn(model, h);
      }
    }
  });
}

// Without depth distances are loose: what may be the same apart from that is compared at one
// distance.
constexpr double kSameDistanceRatio = 0.06;
Pose at_distance_of(const Pose& with, Pose T) {
  const double ratio = with.t_mm.z() / T.t_mm.z();
  if (std::abs(ratio - 1) < kSameDistanceRatio) T.t_mm *= ratio;
  return T;
}

bool near_place(const ObjectModel& model, const Pose& a, const Pose& b) {
  return (a.t_mm - b.t_mm).norm() < kSamePlaceShare * model.info().diameter_mm;
}

bool sane(const Pose& T) {
  return T.t_mm.allFinite() && T.R.allFinite() && T.t_mm.z() > 1;
}

}  // namespace

bool same_pick(const PoseContext& context, int model_index, const Pose& a, const Pose& b) {
  const auto index = static_cast<std::size_t>(model_index);
  return context.moves[index].same(
      a, b, kSamePick.diameters * context.models[index].info().diameter_mm, kSamePick.angle_rad);
}

bool at_one_place(const PoseContext& context, const Hypothesis& a, const Hypothesis& b) {
  const Pose& T = a.T_cam_centre;
  const Pose of_b = context.scene.with_depth ? b.T_cam_centre : at_distance_of(T, b.T_cam_centre);
  return near_place(context.models[a.candidate.model], T, of_b);
}

Neighbours neighbours_of(const PoseContext& context, std::span<const Hypothesis> better,
                         const Hypothesis& h, const SameLimits& same) {
  const ObjectModel& model = context.models[h.candidate.model];
  const double diameter_mm = model.info().diameter_mm;
  const PartMoves& moves = context.moves[h.candidate.model];
  Neighbours near;
  for (const Hypothesis& other : better) {
    if (other.candidate.model != h.candidate.model) continue;
    const auto meet = [&](const Pose& T) {
      near.repeated =
          moves.same(other.T_cam_centre, T, same.diameters * diameter_mm, same.angle_rad);
      near.at_place += near_place(model, other.T_cam_centre, T);
    };
    if (context.scene.with_depth) {
      meet(h.T_cam_centre);
    } else {
      meet(at_distance_of(other.T_cam_centre, h.T_cam_centre));
    }
    if (near.repeated) break;
  }
  return near;
}

ScoreTerms terms_of(const Hypothesis& h) {
  ScoreTerms terms = score_terms(h.evidence, static_cast<double>(h.candidate.score) / kScoreOne);
  terms[static_cast<std::size_t>(ScoreTerm::kRivals)] =
      rivals_term(log_odds(terms, h.evidence.seen), h.rival_odds);
  return terms;
}

bool better_hypothesis(const Hypothesis& a, const Hypothesis& b) {
  if (a.alive != b.alive) return a.alive;
  if (a.rank != b.rank) return a.rank > b.rank;
  return a.candidate < b.candidate;
}

void count_drop(DetectionReport& report, DropReason reason) {
  ++report.dropped[static_cast<std::size_t>(reason)];
}

void run_pnp(const PoseContext& context, std::span<Hypothesis> hypotheses) {
  for_living(context, hypotheses, [&](const ObjectModel& model, Hypothesis& h) {
    if (!context.scene.with_depth) {
      if (!pose_from_contour(model, context.scene, h.T_cam_centre) || !sane(h.T_cam_centre))
        h.drop(DropReason::kPoseDiverged);
      return;
    }
    Correspondence found[kCorrespondencesMax];
    const int count =
        template_correspondences(model, context.scene, h.T_cam_centre, kPnpRangePx, found);
    if (count < 12) return;  // too few edges: ICP goes on from the template's pose
    Pose solved = h.T_cam_centre;
    const PnpResult result =
        solve_pnp({found, static_cast<std::size_t>(count)}, context.scene.intensity.camera, solved);
    // Edges alone leave the distance loose; what they say about the rest of the pose must stay near
    // the template.
    const bool near = rotation_angle_between(solved.R, h.T_cam_centre.R) < 15 * kDegree &&
                      (solved.t_mm - h.T_cam_centre.t_mm).norm() < 0.1 * model.info().diameter_mm;
    if (result.converged && near && sane(solved)) h.T_cam_centre = solved;
  });
}

void run_icp(const PoseContext& context, std::span<Hypothesis> hypotheses) {
  if (!context.scene.with_depth) return;
  for_living(context, hypotheses, [&](const ObjectModel& model, Hypothesis& h) {
    IcpParams params;
    params.sample_step = 2;
    params.gate_start_mm =
        std::max(0.08 * model.info().diameter_mm, 0.004 * h.T_cam_centre.t_mm.z());
    params.gate_end_mm = refine_params(model, context.scene, h.T_cam_centre).depth_gate_mm;
    const IcpResult result = icp(model, context.scene, params, h.T_cam_centre);
    if (result.pairs < 10 || !sane(h.T_cam_centre)) h.drop(DropReason::kPoseDiverged);
  });
}

bool refine_pose(const PoseContext& context, const ObjectModel& model, Pose& T_cam_centre) {
  refine(model, context.scene, refine_params(model, context.scene, T_cam_centre), T_cam_centre);
  return sane(T_cam_centre);
}

void verify_pose(const PoseContext& context, Hypothesis& h) {
  const ObjectModel& model = context.models[h.candidate.model];
  h.evidence = context.scene.with_depth ? verify(model, context.scene, h.T_cam_centre)
                                        : contour_evidence(model, context.scene, h.T_cam_centre);
  h.score = probability(terms_of(h), h.evidence.seen, model.trials());
  h.rank = h.evidence.explained_mm2 * h.score;
}

void run_refine(const PoseContext& context, std::span<Hypothesis> hypotheses) {
  for_living(context, hypotheses, [&](const ObjectModel& model, Hypothesis& h) {
    if (!refine_pose(context, model, h.T_cam_centre)) h.drop(DropReason::kPoseDiverged);
  });
}

void run_verify(const PoseContext& context, std::span<Hypothesis> hypotheses) {
  for_living(context, hypotheses,
             [&](const ObjectModel&, Hypothesis& h) { verify_pose(context, h); });
}

int suppress(const PoseContext& context, std::span<Hypothesis> hypotheses, int per_place,
             DetectionReport& report) {
  for (const Hypothesis& h : hypotheses) {
    if (!h.alive) count_drop(report, h.drop_reason);
  }
  std::sort(hypotheses.begin(), hypotheses.end(), better_hypothesis);
  std::size_t kept = 0;
  for (const Hypothesis& h : hypotheses) {
    if (!h.alive) break;
    const Neighbours near = neighbours_of(context, hypotheses.first(kept), h, kSameRefined);
    if (near.repeated || near.at_place >= per_place) {
      count_drop(report, near.repeated ? DropReason::kDuplicate : DropReason::kLevelLimit);
    } else {
      hypotheses[kept] = h;
      hypotheses[kept++].leads = near.at_place == 0;
    }
  }
  return static_cast<int>(kept);
}

}  // namespace binpick
