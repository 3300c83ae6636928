#include "train/self_match.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <span>

#include "binpick/geometry/angle.hpp"
#include "pose/normal_equations.hpp"

namespace binpick::train {
namespace {

constexpr int kPoints = 6000;       // of the whole part, for the last judgement
constexpr int kFitPoints = 2000;    // for shares
constexpr int kRoughPoints = 200;   // for the search
constexpr int kRefinePoints = 400;  // for refinement
constexpr int kQuickPoints = 200;
constexpr int kFieldCells = 44;  // along the diameter
constexpr double kFieldReachShare = 0.08;
// Facing directions that differ by less belong to one face.
constexpr double kSameFaceCos = 0.99;
constexpr std::size_t kFacesMax = 8;
// Search: all axes are this many directions of a half sphere, every one within 6 degrees.
constexpr int kDirections = 640;
constexpr double kAnyAngleStep = 20 * kDegree;
constexpr double kSpecialAngleStep = 7.5 * kDegree;
// Two moves nearer than this have the same best fit.
constexpr double kSameMoveAngle = 12 * kDegree;
constexpr double kSameMoveShare = 0.06;  // of the diameter
constexpr std::size_t kCandidatesMax = 90;
constexpr int kRefineIterations = 14;

// Geman-McClure: full weight near zero, 1/25 where the distance reaches the scale.
double robust_weight(double distance_mm, double scale_mm) {
  const double k = 1 + 4 * distance_mm * distance_mm / (scale_mm * scale_mm);
  return 1 / (k * k);
}

// Point to plane: `arm` from the pivot to the point.
void add_residual(const Vec3& arm, const Vec3& n, double r, double w, NormalEquations& equations) {
  Eigen::Matrix<double, 6, 1> J;
  J << arm.cross(n), n;
  equations.H += w * J * J.transpose();
  equations.g += w * r * J;
  ++equations.count;
}

double turn_between(const Mat3& A, const Mat3& B) {
  return rotation_angle_between(A, B);
}

void add_axis(std::vector<Vec3>& axes, const Vec3& axis) {
  if (axis.norm() < 1e-3) return;
  const Vec3 a = axis.normalized();
  for (const Vec3& known : axes) {
    if (std::abs(known.dot(a)) > std::cos(2 * kDegree)) return;
  }
  axes.push_back(a);
}

// Directions in which the part shows most of its surface, of either sign, largest first.
std::vector<Vec3> face_directions(const std::vector<ShellPoint>& points) {
  struct Face {
    Vec3 sum;
    double weight;
  };
  std::vector<Face> faces;
  const std::size_t count = std::min<std::size_t>(points.size(), kFitPoints);
  for (const ShellPoint& p : std::span(points).first(count)) {
    Face* best = nullptr;
    double best_cos = kSameFaceCos;
    for (Face& f : faces) {
      const double cosine = std::abs(f.sum.dot(p.normal)) / f.sum.norm();
      if (cosine > best_cos) {
        best_cos = cosine;
        best = &f;
      }
    }
    if (best == nullptr) {
      faces.push_back({p.weight * p.normal, p.weight});
    } else {
      best->sum += (best->sum.dot(p.normal) > 0 ? p.weight : -p.weight) * p.normal;
      best->weight += p.weight;
    }
  }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const Face& a, const Face& b) { return a.weight > b.weight; });
  std::vector<Vec3> directions;
  for (const Face& f : std::span(faces).first(std::min(kFacesMax, faces.size())))
    directions.push_back(f.sum.normalized());
  return directions;
}

}  // namespace

SelfMatcher::SelfMatcher(const Mesh& mesh, double diameter_mm, double similar_mm)
    : tree_(mesh),
      points_(make_shell_points(mesh, tree_, kPoints)),
      diameter_mm_(diameter_mm),
      similar_mm_(similar_mm),
      middle_mm_(Vec3::Zero()),
      frame_(Mat3::Identity()) {
  double weight = 0;
  for (const ShellPoint& p : points_) {
    middle_mm_ += p.weight * p.position_mm;
    weight += p.weight;
  }
  if (weight > 0) middle_mm_ /= weight;
  find_frame();
  fill_field();
}

void SelfMatcher::find_frame() {
  Mat3 inertia = Mat3::Zero();
  for (const ShellPoint& p : points_) {
    const Vec3 x = p.position_mm - middle_mm_;
    inertia += p.weight * x * x.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia);
  const std::vector<Vec3> faces = face_directions(points_);
  for (int k = 0; k < 3; ++k) add_axis(special_axes_, solver.eigenvectors().col(k));
  for (const Vec3& f : faces) add_axis(special_axes_, f);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      add_axis(special_axes_, faces[i].cross(faces[k]));
      add_axis(special_axes_, faces[i] + faces[k]);
      add_axis(special_axes_, faces[i] - faces[k]);
    }
  }
  // The two largest faces that stand across each other give a frame, whatever axes the CAD has.
  if (faces.empty()) return;
  const Vec3 first = faces.front();
  Vec3 second = solver.eigenvectors().col(2);
  if (std::abs(second.dot(first)) > 0.9) second = solver.eigenvectors().col(0);
  for (const Vec3& f : faces) {
    if (std::abs(f.dot(first)) > 0.3) continue;
    second = f;
    break;
  }
  frame_.row(0) = first.transpose();
  frame_.row(1) = (second - second.dot(first) * first).normalized().transpose();
  frame_.row(2) = frame_.row(0).cross(frame_.row(1));
}

void SelfMatcher::fill_field() {
  cell_mm_ = diameter_mm_ / kFieldCells;
  // A part turned about its middle never reaches further than this.
  double radius_mm = 0;
  for (const ShellPoint& p : points_)
    radius_mm = std::max(radius_mm, (p.position_mm - middle_mm_).norm());
  field_size_ = 2 * static_cast<int>(std::ceil(radius_mm / cell_mm_)) + 3;
  field_origin_mm_ = middle_mm_ - Vec3::Constant(cell_mm_ * (field_size_ - 1) / 2.0);
  const double reach_mm = kFieldReachShare * diameter_mm_;
  const auto n = static_cast<std::size_t>(field_size_);
  field_mm_.assign(n * n * n, static_cast<float>(reach_mm));
  std::size_t at = 0;
  for (int z = 0; z < field_size_; ++z) {
    for (int y = 0; y < field_size_; ++y) {
      double before_mm = reach_mm;  // of the cell before: the next one is at most a cell farther
      for (int x = 0; x < field_size_; ++x, ++at) {
        const Vec3 p = field_origin_mm_ + cell_mm_ * Vec3(x, y, z);
        const double limit_mm = std::min(reach_mm, before_mm + 1.01 * cell_mm_);
        before_mm = tree_.nearest(p, limit_mm).distance_mm;
        field_mm_[at] = static_cast<float>(before_mm);
      }
    }
  }
}

// 1 where all points lie on the surface, less the farther they are from it.
double SelfMatcher::rough_score(const Mat3& R, const Vec3& t) const {
  const float reach = static_cast<float>(kFieldReachShare * diameter_mm_);
  const std::size_t count = std::min<std::size_t>(points_.size(), kRoughPoints);
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const ShellPoint& p = points_[i];
    weight += p.weight;
    const Vec3 q = (R * p.position_mm + t - field_origin_mm_) / cell_mm_;
    const int x = static_cast<int>(q.x() + 0.5), y = static_cast<int>(q.y() + 0.5),
              z = static_cast<int>(q.z() + 0.5);
    if (q.minCoeff() < 0 || x >= field_size_ || y >= field_size_ || z >= field_size_) continue;
    const float d = field_mm_[static_cast<std::size_t>((z * field_size_ + y) * field_size_ + x)];
    sum += p.weight * static_cast<double>(1 - d / reach);
  }
  return weight > 0 ? sum / weight : 0;
}

// Of the shifts that put the middle, or in each direction of the frame one of both ends or their
// middle, onto that of the part as it stands.
Pose SelfMatcher::best_shift(const Mat3& R, double& score) const {
  Vec3 low = Vec3::Constant(1e30), high = -low, moved_low = low, moved_high = high;
  const std::size_t count = std::min<std::size_t>(points_.size(), 2 * kRoughPoints);
  const Mat3 turned = frame_ * R;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 a = frame_ * points_[i].position_mm, b = turned * points_[i].position_mm;
    low = low.cwiseMin(a);
    high = high.cwiseMax(a);
    moved_low = moved_low.cwiseMin(b);
    moved_high = moved_high.cwiseMax(b);
  }
  Pose best{R, middle_mm_ - R * middle_mm_};
  score = rough_score(R, best.t_mm);
  for (int choice = 0; choice < 27; ++choice) {
    Vec3 shift;
    for (int k = 0, rest = choice; k < 3; ++k, rest /= 3) {
      const double at_low = low[k] - moved_low[k], at_high = high[k] - moved_high[k];
      shift[k] = rest % 3 == 0 ? (at_low + at_high) / 2 : rest % 3 == 1 ? at_low : at_high;
    }
    const Vec3 t = frame_.transpose() * shift;
    const double here = rough_score(R, t);
    if (here <= score) continue;
    score = here;
    best.t_mm = t;
  }
  return best;
}

std::vector<Pose> SelfMatcher::candidates() const {
  struct Rough {
    Pose move;
    double score;
  };
  std::vector<Rough> all;
  const auto add = [&](const Vec3& axis, double angle) {
    Rough r;
    r.move = best_shift(rotation_from_vector(axis * angle), r.score);
    all.push_back(r);
  };
  for (const Vec3& axis : special_axes_) {
    for (double a = 2 * kSpecialAngleStep; a < kPi + 1e-9; a += kSpecialAngleStep) add(axis, a);
  }
  for (const Vec3& axis : even_directions(kDirections)) {
    if (axis.z() < 0) continue;
    for (double a = kAnyAngleStep; a < kPi + 1e-9; a += kAnyAngleStep) add(axis, a);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Rough& a, const Rough& b) { return a.score > b.score; });
  std::vector<Pose> kept;
  for (const Rough& r : all) {
    if (kept.size() == kCandidatesMax) break;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Pose& k) {
      return turn_between(k.R, r.move.R) < kSameMoveAngle &&
             (k * middle_mm_ - r.move * middle_mm_).norm() < kSameMoveShare * diameter_mm_;
    });
    if (!known) kept.push_back(r.move);
  }
  return kept;
}

Pose SelfMatcher::refined(const Pose& move) const {
  Pose T = move;
  const std::size_t count = std::min<std::size_t>(points_.size(), kRefinePoints);
  const double radius_mm = diameter_mm_ / 4;
  double scale_mm = 0.06 * diameter_mm_;
  const double shrink = std::pow(similar_mm_ / scale_mm, 1.0 / (kRefineIterations - 4));
  for (int i = 0; i < kRefineIterations; ++i) {
    NormalEquations equations;
    const Vec3 pivot = T * middle_mm_;
    for (const ShellPoint& p : std::span(points_).first(count)) {
      const Vec3 x = T * p.position_mm;
      const MeshTree::Nearest near = tree_.nearest(x, 2 * scale_mm);
      if (near.triangle < 0) continue;
      const Vec3& n = tree_.normal(near.triangle);
      if (std::abs(n.dot(T.R * p.normal)) < kAlikeCos) continue;
      const double r = n.dot(x - near.point_mm);
      add_residual(x - pivot, n, r, p.weight * robust_weight(near.distance_mm, scale_mm),
                   equations);
    }
    if (equations.count < 12) return T;
    // Where nothing holds the part, as along an extrusion, it stays.
    const auto step =
        equations.solve(1e-4 * equations.count * radius_mm * radius_mm, 1e-4 * equations.count);
    T = left_increment(T, step.head<3>(), step.tail<3>(), pivot);
    if (scale_mm > similar_mm_) scale_mm = std::max(similar_mm_, scale_mm * shrink);
  }
  T.R = orthonormalized(T.R);
  return T;
}

double SelfMatcher::differing(const Pose& move, std::size_t count, double alike_cos) const {
  double differs = 0, total = 0;
  for (const ShellPoint& p : std::span(points_).first(std::min(count, points_.size()))) {
    total += p.weight;
    const MeshTree::Nearest near = tree_.nearest(move * p.position_mm, similar_mm_);
    const bool coincides = near.triangle >= 0 &&
                           std::abs(tree_.normal(near.triangle).dot(move.R * p.normal)) > alike_cos;
    if (!coincides) differs += p.weight;
  }
  return total > 0 ? differs / total : 1;
}

double SelfMatcher::quick_differing_share(const Pose& move, double alike_cos) const {
  return differing(move, kQuickPoints, alike_cos);
}

double SelfMatcher::differing_share(const Pose& move, double alike_cos) const {
  return (differing(move, kFitPoints, alike_cos) +
          differing(move.inverse(), kFitPoints, alike_cos)) /
         2;
}

SelfFit SelfMatcher::fit(const Pose& move, double alike_cos) const {
  SelfFit fit;
  fit.differing_share = differing_share(move, alike_cos);
  for (const Pose& T : {move, move.inverse()}) {
    for (const ShellPoint& p :
         std::span(points_).first(std::min<std::size_t>(kFitPoints, points_.size()))) {
      const double d = tree_.nearest(T * p.position_mm, 2 * diameter_mm_).distance_mm;
      fit.deviation_mm = std::max(fit.deviation_mm, d);
    }
  }
  return fit;
}

bool SelfMatcher::exact(const Pose& move, double tolerance_mm) const {
  for (const Pose& T : {move, move.inverse()}) {
    for (const ShellPoint& p : points_) {
      if (tree_.nearest(T * p.position_mm, tolerance_mm).triangle < 0) return false;
    }
  }
  return true;
}

}  // namespace binpick::train
