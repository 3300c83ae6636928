#include "pose/alternatives.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "pose/tolerances.hpp"
#include "pose/view_lookup.hpp"

namespace binpick {
namespace {

// A surface is slippable where it moves along its normals by less than this share of a motion (root
// mean square).
constexpr double kSlippageShare = 0.2;
constexpr int kSamplesMin = 20;
constexpr int kAngles = 24;  // of a full rotation: finer than the basin of an alignment
// What is less probable is no pick, whatever it may be taken for.
constexpr double kScoreMin = 0.2;
// Alternatives of one hypothesis, in all, and of the angles about one axis.
constexpr std::size_t kAlternativesMax = kNearTurnsMax + 4;
constexpr std::size_t kPerAxis = 2;

using Vec6d = Eigen::Matrix<double, 6, 1>;
using Mat6d = Eigen::Matrix<double, 6, 6>;

// How far the explained surface moves along its normals: a quadratic form of a motion about its
// middle, rotations in units of its radius.
struct SurfaceMotion {
  Mat6d form = Mat6d::Zero();
  Vec3 middle_mm = Vec3::Zero();
  double radius_mm = 0;
};

std::optional<SurfaceMotion> surface_motion(const ObjectModel& model, const Scene& scene,
                                            const Pose& T) {
  const SampleArrays surface = model.surface(nearest_viewpoint(model, scene.kernels, T));
  const auto on_surface_mm = static_cast<float>(Tolerances(model, scene, T).on_surface_mm);
  simd::SurfaceLook look;
  scene.kernels.look_at_surface(surface, pose_f(T), scene.depth_map, look);
  const auto visit_explained = [&](auto&& visit) {
    for (int i = 0; i < surface.count; ++i) {
      if (!(std::fabs(look.residual_mm[i]) < on_surface_mm)) continue;
      const Eigen::Vector3f p(surface.x[i], surface.y[i], surface.z[i]),
          n(surface.dx[i], surface.dy[i], surface.dz[i]);
      visit(T * p.cast<double>(), T.R * n.cast<double>());
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

// The most probable of a list that grows.
class BestFew {
 public:
  explicit BestFew(std::span<Hypothesis> room) : room_(room) {}
  void offer(const Hypothesis& h) {
    std::size_t at = std::min(count_, room_.size() - 1);
    if (count_ == room_.size() && room_[at].score >= h.score) return;
    count_ = std::min(count_ + 1, room_.size());
    for (; at > 0 && room_[at - 1].score < h.score; --at) room_[at] = room_[at - 1];
    room_[at] = h;
  }
  std::size_t count() const { return count_; }

 private:
  std::span<Hypothesis> room_;
  std::size_t count_ = 0;
};

// Generates the alternatives of one hypothesis into `out`, which is at least kAlternativesMax long.
class Generator {
 public:
  Generator(const PoseContext& context, const Hypothesis& from, std::span<Hypothesis> out)
      : context_(context), from_(from), out_(out) {}

  void run() {
    const SymmetryTransforms& symmetries = context_.symmetries[from_.candidate.model];
    for (const Pose& transform : symmetries.near_rotations())
      out_[count_++] = verified(from_.T_cam_centre * transform);
    // A part turned over may also have rolled.
    const std::size_t sides = count_;
    add_angles(from_.T_cam_centre);
    for (std::size_t i = 0; i < sides && count_ + kPerAxis <= kAlternativesMax; ++i) {
      if (out_[i].score > from_.score) add_angles(out_[i].T_cam_centre);
    }
    add_slippage();
  }

 private:
  Hypothesis verified(const Pose& T) const {
    Hypothesis h = from_;
    h.is_local_best = false;
    h.T_cam_centre = T;
    verify_one(context_, h);
    return h;
  }

  // The best about the near-symmetric axes.
  void add_angles(const Pose& T) {
    BestFew best(out_.subspan(count_, kPerAxis));
    for (const Pose& transform : context_.symmetries[from_.candidate.model].near_angles())
      best.offer(verified(T * transform));
    count_ += best.count();
  }

  // The best local maxima about the axis on which the measured surface slips.
  void add_slippage() {
    const ObjectModel& model = context_.models[from_.candidate.model];
    const auto axis = slippage_axis(model, context_.scene, from_.T_cam_centre);
    if (!axis || count_ + kPerAxis > kAlternativesMax) return;
    std::array<Hypothesis, kAngles> angles;
    for (int i = 1; i < kAngles; ++i) {
      angles[static_cast<std::size_t>(i)] =
          verified(left_increment(from_.T_cam_centre, i * 2 * kPi / kAngles * axis->direction,
                                  Vec3::Zero(), axis->point_mm));
    }
    angles[0] = from_;
    const auto score = [&](int i) { return angles[static_cast<std::size_t>(i % kAngles)].score; };
    BestFew best(out_.subspan(count_, kPerAxis));
    for (int i = 1; i < kAngles; ++i) {
      if (score(i) >= score(i - 1) && score(i) >= score(i + 1))
        best.offer(angles[static_cast<std::size_t>(i)]);
    }
    count_ += best.count();
  }

  const PoseContext& context_;
  const Hypothesis& from_;
  std::span<Hypothesis> out_;
  std::size_t count_ = 0;
};

}  // namespace

std::optional<RotationAxis> slippage_axis(const ObjectModel& model, const Scene& scene,
                                          const Pose& T) {
  const auto motion = surface_motion(model, scene, T);
  if (!motion) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Mat6d> solver(motion->form);  // ascending
  // Of the slippable motions, the one that rotates most.
  int free = 0;
  while (free < 6 && solver.eigenvalues()[free] < kSlippageShare * kSlippageShare) ++free;
  if (free == 0) return std::nullopt;
  Mat3 rotating = Mat3::Zero();
  for (int i = 0; i < free; ++i) {
    const Vec3 w = solver.eigenvectors().col(i).head<3>();
    rotating += w * w.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Mat3> rotations;
  rotations.computeDirect(rotating);
  if (rotations.eigenvalues()[2] < 0.1) return std::nullopt;  // only shifts
  const Vec3 direction = rotations.eigenvectors().col(2);
  Vec6d combined = Vec6d::Zero();
  for (int i = 0; i < free; ++i) {
    const Vec6d m = solver.eigenvectors().col(i);
    combined += m.head<3>().dot(direction) * m;
  }
  const Vec3 w = combined.head<3>() / motion->radius_mm, v = combined.tail<3>();
  return RotationAxis{motion->middle_mm + w.cross(v) / w.squaredNorm(), w.normalized()};
}

std::size_t add_alternatives(const PoseContext& context, std::span<Hypothesis> list,
                             std::size_t count) {
  if (!context.scene.with_depth) return count;
  // Their places in the list, before any is filled: the same on any number of threads.
  std::size_t end = count;
  for (std::size_t i = 0; i < count && end + kAlternativesMax <= list.size(); ++i) {
    if (!list[i].is_local_best || list[i].score < kScoreMin) continue;
    list[end] = list[i];
    for (std::size_t k = 0; k < kAlternativesMax; ++k) list[end++].drop(DropReason::kDuplicate);
  }
  const auto tasks = static_cast<int>((end - count) / kAlternativesMax);
  context.pool.parallel_for(tasks, [&](int task, int) {
    const std::span<Hypothesis> out =
        list.subspan(count + static_cast<std::size_t>(task) * kAlternativesMax, kAlternativesMax);
    Hypothesis from = out[0];
    from.alive = true;
    if (context.deadline.passed()) {
      out[0].drop(DropReason::kDeadline);
    } else {
      Generator(context, from, out).run();
    }
  });
  // Places that nothing was found for are no hypotheses, and nothing to count.
  const auto added = list.subspan(count, end - count);
  const auto living = std::remove_if(added.begin(), added.end(), [](const Hypothesis& h) {
    return !h.alive && h.drop_reason == DropReason::kDuplicate;
  });
  return count + static_cast<std::size_t>(living - added.begin());
}

}  // namespace binpick
