#include "pose/loose_turns.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

// A surface is loose where it moves along its normals by less than this share of a motion (root
// mean square).
constexpr double kLooseShare = 0.2;
constexpr int kSamplesMin = 20;
constexpr int kSteps = 24;  // of a full turn: finer than a refinement reaches
constexpr int kKept = 2;
// Less probable poses are not worth the time.
constexpr double kScoreMin = 0.3;

using Vec6d = Eigen::Matrix<double, 6, 1>;
using Mat6d = Eigen::Matrix<double, 6, 6>;

// How far the explained surface moves along its normals: a quadratic form of a motion about its
// middle, turns in units of its radius.
struct SurfaceMotion {
  Mat6d form = Mat6d::Zero();
  Vec3 middle_mm = Vec3::Zero();
  double radius_mm = 0;
};

std::optional<SurfaceMotion> surface_motion(const ObjectModel& model, const Scene& scene,
                                            const Pose& T) {
  const auto visit_explained = [&](auto&& visit) {
    for (const SurfaceSample& s : model.surface(nearest_viewpoint(model, T))) {
      const Vec3 p = T * position_of(s), n = T.R * normal_of(s);
      if (scene.lies_on_measured(scene.measured_at(p), p, n, T.t_mm.z())) visit(p, n);
    }
  };
  SurfaceMotion out;
  int count = 0;
  double squares = 0;
  visit_explained([&](const Vec3& p, const Vec3&) {
    out.middle_mm += p;
    squares += p.squaredNorm();
    ++count;
  });
  if (count < kSamplesMin) return std::nullopt;
  out.middle_mm /= count;
  out.radius_mm = std::sqrt(std::max(1e-6, squares / count - out.middle_mm.squaredNorm()));
  visit_explained([&](const Vec3& p, const Vec3& n) {
    Vec6d row;
    row << (p - out.middle_mm).cross(n) / out.radius_mm, n;
    out.form.noalias() += row * row.transpose();
  });
  out.form /= count;
  return out;
}

// The poses of one turn, until an exact symmetry makes the part the same again; verified. How many.
int turn_around(const PoseContext& context, const Hypothesis& from, const LooseTurn& turn,
                std::span<Hypothesis, kSteps> steps) {
  const ObjectModel& model = context.models[from.candidate.model];
  const PartMoves& moves = context.moves[from.candidate.model];
  constexpr double kStepRad = 2 * kPi / kSteps;
  steps[0] = from;
  for (int i = 1; i < kSteps; ++i) {
    const Pose T =
        left_increment(from.T_cam_centre, i * kStepRad * turn.axis, Vec3::Zero(), turn.point_mm);
    if (same_pick(context, from.candidate.model, from.T_cam_centre, T)) return i;
    Hypothesis& step = steps[static_cast<std::size_t>(i)];
    step = from;
    step.T_cam_centre = moves.canonical(model, T);
    verify_pose(context, step);
  }
  return kSteps;
}

// The best local maxima of the score about the circle, refined, into `out`; the rest of it stays
// dropped.
void try_turns(const PoseContext& context, const Hypothesis& from, const LooseTurn& turn,
               std::span<Hypothesis> out) {
  std::array<Hypothesis, kSteps> steps;
  const int count = turn_around(context, from, turn, steps);
  const auto score = [&](int i) { return steps[static_cast<std::size_t>(i % count)].score; };
  std::array<bool, kSteps> taken{true};
  for (Hypothesis& h : out) {
    int best = 0;
    for (int i = 1; i < count; ++i) {
      const bool peak = score(i) >= score(i - 1) && score(i) >= score(i + 1);
      if (peak && !taken[static_cast<std::size_t>(i)] && (best == 0 || score(i) > score(best)))
        best = i;
    }
    if (best == 0) return;
    taken[static_cast<std::size_t>(best)] = true;
    h = steps[static_cast<std::size_t>(best)];
    if (refine_pose(context, context.models[h.candidate.model], h.T_cam_centre)) {
      h.alive = true;
      verify_pose(context, h);
    } else {
      h.drop(DropReason::kPoseDiverged);
    }
  }
}

}  // namespace

std::optional<LooseTurn> loose_turn(const ObjectModel& model, const Scene& scene, const Pose& T) {
  const auto motion = surface_motion(model, scene, T);
  if (!motion) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Mat6d> solver(motion->form);  // ascending
  // Of the loose motions, the one that turns most.
  int loose = 0;
  while (loose < 6 && solver.eigenvalues()[loose] < kLooseShare * kLooseShare) ++loose;
  if (loose == 0) return std::nullopt;
  Mat3 turning = Mat3::Zero();
  for (int i = 0; i < loose; ++i) {
    const Vec3 w = solver.eigenvectors().col(i).head<3>();
    turning += w * w.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Mat3> turns;
  turns.computeDirect(turning);
  if (turns.eigenvalues()[2] < 0.1) return std::nullopt;  // only shifts
  const Vec3 axis = turns.eigenvectors().col(2);
  Vec6d combined = Vec6d::Zero();
  for (int i = 0; i < loose; ++i) {
    const Vec6d m = solver.eigenvectors().col(i);
    combined += m.head<3>().dot(axis) * m;
  }
  const Vec3 w = combined.head<3>() / motion->radius_mm, v = combined.tail<3>();
  return LooseTurn{motion->middle_mm + w.cross(v) / w.squaredNorm(), w.normalized()};
}

int add_loose_turns(const PoseContext& context, std::span<Hypothesis> list, int count) {
  if (!context.scene.with_depth) return count;
  const int room = (static_cast<int>(list.size()) - count) / kKept;
  int tried = 0;
  // Their places in the list, before any is filled: the same on any number of threads.
  for (int i = 0; i < count && tried < room; ++i) {
    const Hypothesis& h = list[static_cast<std::size_t>(i)];
    if (!h.leads || h.score < kScoreMin) continue;
    for (int k = 0; k < kKept; ++k) {
      Hypothesis& next = list[static_cast<std::size_t>(count + kKept * tried + k)];
      next = h;
      next.drop(DropReason::kDuplicate);
    }
    ++tried;
  }
  context.pool.parallel_for(tried, [&](int i, int) {
    const std::span<Hypothesis> out =
        list.subspan(static_cast<std::size_t>(count + kKept * i), kKept);
    const Hypothesis from = out[0];
    const ObjectModel& model = context.models[from.candidate.model];
    if (context.deadline.passed()) {
      out[0].drop(DropReason::kDeadline);
    } else if (const auto turn = loose_turn(model, context.scene, from.T_cam_centre)) {
      try_turns(context, from, *turn, out);
    }
  });
  // Places that nothing was found for are no hypotheses, and nothing to count.
  const auto added =
      list.subspan(static_cast<std::size_t>(count), static_cast<std::size_t>(kKept * tried));
  const auto end = std::remove_if(added.begin(), added.end(), [](const Hypothesis& h) {
    return !h.alive && h.drop_reason == DropReason::kDuplicate;
  });
  return count + static_cast<int>(end - added.begin());
}

}  // namespace binpick
