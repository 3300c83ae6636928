#include "assess/depth_look.hpp"

#include <cmath>

#include "assess/repeatability.hpp"

namespace binpick::app {
namespace {

constexpr double kInFront = 0.05;  // of the diameter: another part, not this one's own noise
constexpr std::size_t kPixelsMin = 100;

const Viewpoint& nearest_viewpoint(const ObjectModel& model, const Pose& T_cam_centre) {
  const Vec3 seen = T_cam_centre.R.transpose() * T_cam_centre.t_mm.normalized();
  const SampleArrays directions = model.viewing_directions();
  int nearest = 0;
  double nearest_cos = -2;
  for (int i = 0; i < directions.count; ++i) {
    const double cos =
        seen.dot(Eigen::Vector3f(directions.x[i], directions.y[i], directions.z[i]).cast<double>());
    if (cos > nearest_cos) nearest = i, nearest_cos = cos;
  }
  return model.depth(model.depth_count() - 1).viewpoints[static_cast<std::size_t>(nearest)];
}

}  // namespace

double missing_share(const ObjectModel& model, const Frame& frame, const Pose& T_cam_centre) {
  if (frame.depth_mm.empty()) return 0;
  const SampleArrays surface = model.surface(nearest_viewpoint(model, T_cam_centre));
  const double in_front_mm = kInFront * model.info().diameter_mm;
  int visible = 0, missing = 0;
  for (int i = 0; i < surface.count; ++i) {
    const Vec3 p =
        T_cam_centre * Eigen::Vector3f(surface.x[i], surface.y[i], surface.z[i]).cast<double>();
    if (!(p.z() > 0)) continue;
    const Vec2 pixel = frame.camera.project(p);
    const long x = std::lround(pixel.x()), y = std::lround(pixel.y());
    if (x < 0 || y < 0 || x >= frame.camera.width || y >= frame.camera.height) continue;
    const float z = frame.depth_mm.at(static_cast<int>(x), static_cast<int>(y));
    const bool measured = is_measured(z);
    if (measured && static_cast<double>(z) < p.z() - in_front_mm) continue;
    ++visible;
    missing += !measured;
  }
  return visible > 0 ? static_cast<double>(missing) / visible : 0;
}

void DepthScatter::add(const Frame& frame) {
  if (frame.depth_mm.empty()) return;
  const int width = frame.camera.width;
  pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(frame.camera.height));
  const PixelRange range = pixels_of(frame.roi, width, frame.camera.height);
  ++frames_;
  for (int y = range.y0; y < range.y1; ++y) {
    for (int x = range.x0; x < range.x1; ++x) {
      const float z = frame.depth_mm.at(x, y);
      if (!is_measured(z)) continue;
      Pixel& p = pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(x)];
      const float step = z - p.mean;
      p.mean += step / static_cast<float>(++p.count);
      p.squares += step * (z - p.mean);
    }
  }
}

double DepthScatter::median_mm() const {
  std::vector<double> sigmas;
  for (const Pixel& p : pixels_) {
    if (p.count > 1 && 2 * p.count > frames_)
      sigmas.push_back(std::sqrt(static_cast<double>(p.squares) / (p.count - 1)));
  }
  return sigmas.size() < kPixelsMin ? 0 : median_of(std::move(sigmas));
}

}  // namespace binpick::app
