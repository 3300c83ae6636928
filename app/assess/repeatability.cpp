#include "assess/repeatability.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"

namespace binpick::app {
namespace {

// A camera axis this near to an axis of the part (cosine).
constexpr double kAlongAxis = 0.9;
constexpr double kCopies = 1e-9;  // mm, deg: copies of one frame

using Six = std::array<double, kDirectionCount>;

// Shift in mm, rotation in degrees, in camera axes.
Six difference(const Pose& pose, const Pose& mean) {
  const Vec3 shift = pose.t_mm - mean.t_mm;
  const Vec3 turn = rotation_vector(pose.R * mean.R.transpose()) / kDegree;
  return {shift.x(), shift.y(), shift.z(), turn.x(), turn.y(), turn.z()};
}

// Takes out rotations about the part's axes.
Mat3 observable_rotations(const Pose& mean, const SamePose& part) {
  if (part.ball()) return Mat3::Zero();
  Mat3 P = Mat3::Identity();
  for (const SamePose::Axis& axis : part.axes()) {
    const Vec3 a = mean.R * axis.direction;
    P = P * (Mat3::Identity() - a * a.transpose());
  }
  return P;
}

}  // namespace

double Repeatability::claim(int direction) const {
  const auto i = static_cast<std::size_t>(direction);
  return unobservable[i] || sigma[i] < kCopies ? 0 : claimed[i] / sigma[i];
}

Repeatability repeatability_of(const Track& track, std::span<const Observation> observations,
                               const SamePose& part) {
  Repeatability out;
  out.count = static_cast<int>(track.poses.size());
  const double count = out.count;
  for (const Pose& pose : track.poses) {
    const Six d = difference(pose, track.mean);
    for (std::size_t i = 0; i < d.size(); ++i) out.sigma[i] += d[i] * d[i] / (count - 1);
  }
  const Mat3 P = observable_rotations(track.mean, part);
  for (const std::size_t index : track.seen) {
    const Mat6& C = observations[index].covariance;
    const Mat3 turn = P * C.topLeftCorner<3, 3>() * P.transpose();
    for (int i = 0; i < 3; ++i) {
      out.claimed[static_cast<std::size_t>(i)] += C(3 + i, 3 + i) / count;
      out.claimed[static_cast<std::size_t>(3 + i)] += turn(i, i) / (kDegree * kDegree) / count;
    }
  }
  for (double& v : out.sigma) v = std::sqrt(v);
  for (double& v : out.claimed) v = std::sqrt(v);
  for (int i = 0; i < 3; ++i) {
    // How much of the camera axis is left without the part's axes.
    const double left = P.col(i).norm();
    out.unobservable[static_cast<std::size_t>(3 + i)] =
        left < std::sqrt(1 - kAlongAxis * kAlongAxis);
  }
  return out;
}

DirectionSummary summarize(std::span<const Repeatability> parts) {
  DirectionSummary out;
  for (int d = 0; d < kDirectionCount; ++d) {
    const auto i = static_cast<std::size_t>(d);
    std::vector<double> sigmas, claims;
    for (const Repeatability& r : parts) {
      if (!r.unobservable[i]) sigmas.push_back(r.sigma[i]);
      if (const double claim = r.claim(d); claim > 0) claims.push_back(claim);
    }
    if (!sigmas.empty()) out.worst[i] = std::ranges::max(sigmas);
    out.median[i] = median_of(std::move(sigmas));
    out.claim[i] = median_of(std::move(claims));
  }
  return out;
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

}  // namespace binpick::app
