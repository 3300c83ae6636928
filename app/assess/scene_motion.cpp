#include "assess/scene_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "binpick/geometry/angle.hpp"

namespace binpick::app {
namespace {

constexpr std::size_t kPosesMax = 20;  // of a frame: the most probable ones
constexpr double kAgrees = 0.4;  // with a refined motion; a chance match is mostly farther off
constexpr int kRefinements = 4;
constexpr double kOutlier = 3;  // times the median distance
// Two motions differ where they take the scene this far apart.
constexpr double kOtherAngle = 20 * kDegree;

struct Pair {
  const Observation* from = nullptr;
  Pose aligned;  // the pose in the other frame, in the form nearest to where the motion takes it
  double distance = 0;
};

std::vector<const Observation*> most_probable(std::span<const Observation> poses) {
  std::vector<const Observation*> list;
  for (const Observation& o : poses) list.push_back(&o);
  std::ranges::stable_sort(list, [](auto* a, auto* b) { return a->score > b->score; });
  list.resize(std::min(list.size(), kPosesMax));
  return list;
}

class MotionFinder {
 public:
  MotionFinder(std::span<const Observation> from, std::span<const Observation> to,
               std::span<const SamePose> parts)
      : from_(most_probable(from)), to_(most_probable(to)), parts_(parts) {}

  SceneMotion run() {
    for (const Observation* a : from_) {
      for (const Observation* b : to_)
        if (a->model == b->model) add_candidates(*a, *b);
    }
    SceneMotion out;
    out.compared = static_cast<int>(std::min(from_.size(), to_.size()));
    const auto best = std::ranges::max_element(candidates_, {}, &Candidate::agreeing);
    if (best == candidates_.end()) return out;
    out.motion = refined(best->motion);
    std::vector<Pair> pairs = agreeing_pairs(out.motion);
    std::erase_if(pairs, [](const Pair& p) { return p.distance > kAgrees; });
    out.agreeing = static_cast<int>(pairs.size());
    if (pairs.empty()) return out;
    double all = 0, agreed = 0;
    for (const Observation* a : from_) all += a->score;
    for (const Pair& p : pairs) agreed += p.from->score;
    out.score_share = all > 0 ? agreed / all : 0;
    const Vec3 middle = middle_of(pairs);
    for (const Candidate& c : candidates_) {
      if (is_other(c.motion, out.motion, middle))
        out.next_best = std::max(out.next_best, c.agreeing);
    }
    out.shift_mm = (out.motion * middle - middle).norm();
    out.angle_rad = rotation_angle_between(out.motion.R, Mat3::Identity());
    return out;
  }

 private:
  struct Candidate {
    Pose motion;
    int agreeing = 0;
  };

  const SamePose& part_of(const Observation& o) const {
    return parts_[static_cast<std::size_t>(o.model)];
  }

  // The motions that take one pose onto the other.
  void add_candidates(const Observation& a, const Observation& b) {
    const SamePose& part = part_of(a);
    if (part.ball()) return;
    for (const Pose& transform : part.transforms()) {
      const Pose motion = b.T_cam_centre * transform * a.T_cam_centre.inverse();
      add(motion);
      for (const SamePose::Axis& axis : part.axes()) add_about_axis(motion, a, b, axis);
    }
  }

  // The angle about the part's axis is open: a second pose gives it.
  void add_about_axis(const Pose& motion, const Observation& a, const Observation& b,
                      const SamePose::Axis& axis) {
    const Vec3 point = b.T_cam_centre * axis.point_mm;
    const Vec3 direction = b.T_cam_centre.R * axis.direction;
    const auto across = [&](const Vec3& x) -> Vec3 {
      return x - point - direction * direction.dot(x - point);
    };
    const double limit_mm = part_of(a).diameter_mm() / 4;
    for (const Observation* a2 : from_) {
      const Vec3 start = motion * a2->T_cam_centre.t_mm;
      const Vec3 u = across(start);
      if (a2 == &a || u.norm() < limit_mm) continue;
      for (const Observation* b2 : to_) {
        const Vec3& end = b2->T_cam_centre.t_mm;
        const Vec3 v = across(end);
        if (b2 == &b || b2->model != a2->model || std::abs(u.norm() - v.norm()) > limit_mm ||
            std::abs(direction.dot(start - end)) > limit_mm)
          continue;
        const Mat3 R =
            rotation_from_vector(direction * std::atan2(direction.dot(u.cross(v)), u.dot(v)));
        add(Pose{R, point - R * point} * motion);
      }
    }
  }

  void add(const Pose& motion) {
    const auto count = static_cast<int>(agreeing_pairs(motion).size());
    if (count > 1) candidates_.push_back({motion, count});
  }

  std::vector<Pair> agreeing_pairs(const Pose& motion) const {
    std::vector<Pair> pairs;
    for (const Observation* a : from_) {
      const SamePose& part = part_of(*a);
      const Pose there = motion * a->T_cam_centre;
      Pair best{nullptr, {}, 1};
      for (const Observation* b : to_) {
        if (b->model != a->model || (b->T_cam_centre.t_mm - there.t_mm).norm() > part.diameter_mm())
          continue;
        const double distance = part.distance(b->T_cam_centre, there);
        if (distance < best.distance) best = {a, part.nearest(b->T_cam_centre, there), distance};
      }
      if (best.from != nullptr) pairs.push_back(best);
    }
    return pairs;
  }

  // Least squares over the middles of the parts and points about them, without what lies far off.
  Pose refined(Pose motion) const {
    for (int i = 0; i < kRefinements; ++i) {
      std::vector<Pair> pairs = agreeing_pairs(motion);
      if (pairs.size() < 2) return motion;
      std::ranges::sort(pairs, {}, &Pair::distance);
      const double limit = kOutlier * pairs[pairs.size() / 2].distance;
      std::erase_if(pairs, [&](const Pair& p) { return p.distance > limit; });
      Eigen::Matrix3Xd before(3, 4 * pairs.size()), after(3, 4 * pairs.size());
      Eigen::Index column = 0;
      for (const Pair& p : pairs) {
        const double radius_mm = part_of(*p.from).diameter_mm() / 4;
        for (int k = -1; k < 3; ++k, ++column) {
          const Vec3 x = k < 0 ? Vec3(Vec3::Zero()) : Vec3(radius_mm * Vec3::Unit(k));
          before.col(column) = p.from->T_cam_centre * x;
          after.col(column) = p.aligned * x;
        }
      }
      const Eigen::Matrix4d M = Eigen::umeyama(before, after, false);
      motion = {orthonormalized(M.topLeftCorner<3, 3>()), M.topRightCorner<3, 1>()};
    }
    return motion;
  }

  static Vec3 middle_of(const std::vector<Pair>& pairs) {
    Vec3 sum = Vec3::Zero();
    for (const Pair& p : pairs) sum += p.from->T_cam_centre.t_mm;
    return sum / static_cast<double>(pairs.size());
  }

  bool is_other(const Pose& a, const Pose& b, const Vec3& middle) const {
    double diameter_mm = 0;
    for (const SamePose& part : parts_) diameter_mm = std::max(diameter_mm, part.diameter_mm());
    return (a * middle - b * middle).norm() > diameter_mm / 2 ||
           rotation_angle_between(a.R, b.R) > kOtherAngle;
  }

  std::vector<const Observation*> from_, to_;
  std::span<const SamePose> parts_;
  std::vector<Candidate> candidates_;
};

}  // namespace

SceneMotion find_motion(std::span<const Observation> from, std::span<const Observation> to,
                        std::span<const SamePose> parts) {
  return MotionFinder(from, to, parts).run();
}

}  // namespace binpick::app
