#include "eval/tell_apart.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace binpick::app {
namespace {

constexpr int kSidePxMax = 800;
// Measurements this near to the rendered surface belong to the part when its noise is estimated.
constexpr double kPartMm = 5;
constexpr double kNoiseMinMm = 0.15;
constexpr double kToleranceSigmas = 3;
constexpr double kNeutral = 0.5;
// Pixels whose costs differ by less say the same.
constexpr double kCostStep = 0.1;

struct Box {
  double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
};

void extend(Box& box, const train::Mesh& mesh, const CameraIntrinsics& camera, const Pose& T) {
  for (const Eigen::Vector3f& v : mesh.vertices_mm) {
    const Vec3 p = T * v.cast<double>();
    if (p.z() < 1) continue;
    const Vec2 px = camera.project(p);
    box = {std::min(box.left, px.x()), std::min(box.top, px.y()), std::max(box.right, px.x()),
           std::max(box.bottom, px.y())};
  }
}

// The part of the image that shows either pose, as a rectangle inside it; empty where none does.
Roi window_of(const Frame& frame, const train::Mesh& mesh, const Pose& a, const Pose& b) {
  Box box;
  extend(box, mesh, frame.camera, a);
  extend(box, mesh, frame.camera, b);
  const int width = frame.depth_mm.width, height = frame.depth_mm.height;
  const int x0 = static_cast<int>(std::clamp<double>(std::floor(box.left) - 1, 0, width));
  const int y0 = static_cast<int>(std::clamp<double>(std::floor(box.top) - 1, 0, height));
  const int x1 = static_cast<int>(std::clamp<double>(std::ceil(box.right) + 2, 0, width));
  const int y1 = static_cast<int>(std::clamp<double>(std::ceil(box.bottom) + 2, 0, height));
  return {x0, y0, std::min(x1 - x0, kSidePxMax), std::min(y1 - y0, kSidePxMax)};
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// 1.4826 times the median distance from the median: a standard deviation that outliers do not move.
double noise_of(std::vector<double>& residuals) {
  if (residuals.empty()) return kNoiseMinMm;
  const double middle = median(residuals);
  for (double& r : residuals) r = std::abs(r - middle);
  return std::max(kNoiseMinMm, 1.4826 * median(residuals));
}

}  // namespace

double pixel_cost(double measured_mm, double rendered_mm, double tolerance_mm) {
  if (!(rendered_mm > 0)) return kNeutral;
  const double r = (measured_mm - rendered_mm) / tolerance_mm;
  if (r > 1) return 1;
  if (r < -1) return kNeutral;
  return kNeutral * r * r;
}

PoseComparison PoseComparer::compare(const Frame& frame, const train::Mesh& mesh, const Pose& first,
                                     const Pose& second) {
  PoseComparison out;
  const Roi window = window_of(frame, mesh, first, second);
  if (window.width <= 0 || window.height <= 0) return out;
  auto& renderer = renderers_[&mesh];
  if (!renderer) renderer = std::make_unique<train::Renderer>(mesh, kSidePxMax, kSidePxMax);
  CameraIntrinsics camera = frame.camera;
  camera.cx -= window.x;
  camera.cy -= window.y;
  camera.width = window.width;
  camera.height = window.height;
  renderer->render(camera, first, first_);
  renderer->render(camera, second, second_);
  const auto depth = frame.depth_mm.crop(window.x, window.y, window.width, window.height);

  std::vector<double> residuals;
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * window.width + x); };
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) {
      const double a = static_cast<double>(first_.depth_mm[at(x, y)]);
      out.silhouette_px += a > 0;
      const float z = depth.at(x, y);
      if (!(a > 0) || !is_measured(z)) continue;
      const double r = static_cast<double>(z) - a;
      if (std::abs(r) < kPartMm) residuals.push_back(r);
    }
  }
  out.supported_px = static_cast<int>(residuals.size());
  out.noise_mm = noise_of(residuals);
  const double tolerance_mm = kToleranceSigmas * out.noise_mm;
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) {
      const float z = depth.at(x, y);
      if (!is_measured(z)) continue;
      const double a = static_cast<double>(first_.depth_mm[at(x, y)]),
                   b = static_cast<double>(second_.depth_mm[at(x, y)]);
      const double mm = static_cast<double>(z);
      out.measured_px += a > 0 && mm > a - tolerance_mm;
      const double gain = pixel_cost(mm, b, tolerance_mm) - pixel_cost(mm, a, tolerance_mm);
      out.advantage_px += gain;
      out.differing_px += std::abs(gain) > kCostStep;
    }
  }
  return out;
}

}  // namespace binpick::app
