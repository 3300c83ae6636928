#include "replay/cloud_frame.hpp"

#include <algorithm>
#include <cmath>

#include "replay/point_cloud.hpp"
#include "replay/undistort_frame.hpp"

namespace binpick::drivers {
namespace {

constexpr double kOnRay_px = 1;          // farther off, a point belongs to another pixel
constexpr double kOnRayShare = 0.999;    // single points may be noise
constexpr double kFitsShare = 0.02;      // of the width: a lens bends the rays by less
constexpr std::size_t kPointsMin = 100;  // to fit a camera to
constexpr int kFitRounds = 4;

// A point that was measured, and the pixel of the grid that saw it.
struct Sight {
  int u, v;
  std::size_t index;
  float x, y, z;
};

void find_grid(const std::string& path, PointCloud& cloud, const CameraIntrinsics& camera,
               const ImageBuffer<std::uint8_t>& intensity) {
  const auto is_grid = [&](int width, int height) {
    return width > 1 && height > 1 &&
           static_cast<std::size_t>(width) * static_cast<std::size_t>(height) ==
               cloud.points.size();
  };
  const auto take = [&](int width, int height) {
    cloud.width = width;
    cloud.height = height;
  };
  const std::string holds = path + ": holds " + std::to_string(cloud.points.size()) + " points";
  if (is_grid(cloud.width, cloud.height)) return;
  if (is_grid(intensity.width, intensity.height)) return take(intensity.width, intensity.height);
  if (is_grid(camera.width, camera.height)) return take(camera.width, camera.height);
  if (cloud.width > 0 && cloud.height > 0)
    throw DatasetError(holds + ", its header tells a grid of " +
                       size_text(cloud.width, cloud.height));
  if (cloud.has_faces)
    throw DatasetError(path +
                       ": is a mesh: a part goes to binpick train; depth has to be an image "
                       "or an organized point cloud");
  throw DatasetError(holds +
                     " without a grid: it is an unorganized cloud. Export it organized (ordered, "
                     "with invalid points kept), one point for each pixel, or as a depth image");
}

std::vector<Sight> measured_points(const std::string& path, const PointCloud& cloud) {
  std::vector<Sight> sights;
  std::size_t behind = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto& [x, y, z] = cloud.points[i];
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z) || z == 0) continue;
    behind += z < 0;
    const int index = static_cast<int>(i);
    if (z > 0) sights.push_back({index % cloud.width, index / cloud.width, i, x, y, z});
  }
  if (behind > sights.size())
    throw DatasetError(path +
                       ": its points have negative z: expected are camera coordinates, x "
                       "right, y down, z along the view; turn y and z round");
  return sights;
}

// The line through (slope, pixel) pairs that most of them lie on.
struct Line {
  double focal = 0, centre = 0;
};
template <class Slope, class Pixel>
Line fit_line(const std::vector<Sight>& sights, Slope slope, Pixel pixel) {
  Line line;
  double limit_px = INFINITY;
  for (int round = 0; round < kFitRounds; ++round) {
    double n = 0, s = 0, p = 0, ss = 0, sp = 0, squares = 0;
    const auto error = [&](const Sight& t) {
      return pixel(t) - line.focal * slope(t) - line.centre;
    };
    for (const Sight& t : sights) {
      if (round > 0 && std::abs(error(t)) > limit_px) continue;
      n += 1, s += slope(t), p += pixel(t), ss += slope(t) * slope(t), sp += slope(t) * pixel(t);
    }
    const double spread = n * ss - s * s;
    if (n < 2 || spread <= 0) return {};
    line.focal = (n * sp - s * p) / spread;
    line.centre = (p - line.focal * s) / n;
    for (const Sight& t : sights)
      if (std::abs(error(t)) <= limit_px) squares += error(t) * error(t);
    limit_px = std::max(3 * std::sqrt(squares / n), 0.1);
  }
  return line;
}

CameraIntrinsics fit_camera(const std::string& path, const PointCloud& cloud,
                            const std::vector<Sight>& sights) {
  if (sights.size() < kPointsMin)
    throw DatasetError(path + ": has only " + std::to_string(sights.size()) +
                       " measured points, too few to find the camera: give --camera");
  const Line u = fit_line(
      sights, [](const Sight& t) { return static_cast<double>(t.x) / t.z; },
      [](const Sight& t) { return t.u; });
  const Line v = fit_line(
      sights, [](const Sight& t) { return static_cast<double>(t.y) / t.z; },
      [](const Sight& t) { return t.v; });
  return {cloud.width, cloud.height, u.focal, v.focal, u.centre, v.centre};
}

// How far the points lie from the pixels that saw them, in px: of half of them, and of nearly all.
struct Residuals {
  double half_px = 0, most_px = 0;
};
Residuals residuals_of(const std::vector<Sight>& sights, const CameraIntrinsics& camera,
                       const LensDistortion& lens) {
  if (sights.empty()) return {};
  std::vector<double> errors;
  errors.reserve(sights.size());
  for (const Sight& t : sights) {
    const Vec2 p = lens.distort({static_cast<double>(t.x) / t.z, static_cast<double>(t.y) / t.z});
    errors.push_back(std::max(std::abs(p.x() * camera.fx + camera.cx - t.u),
                              std::abs(p.y() * camera.fy + camera.cy - t.v)));
  }
  const auto at = [&](double share) {
    const auto i = static_cast<std::ptrdiff_t>(share * static_cast<double>(errors.size() - 1));
    std::nth_element(errors.begin(), errors.begin() + i, errors.end());
    return errors[static_cast<std::size_t>(i)];
  };
  return {at(0.5), at(kOnRayShare)};
}

// Depth of each point into the pixel that a pinhole camera sees it in, with its gray.
void project(const std::vector<Sight>& sights, const std::vector<std::uint8_t>& gray,
             LoadedFrame& frame) {
  for (const Sight& t : sights) {
    const Vec2 p = frame.camera.project(Vec3(t.x, t.y, t.z));
    const long u = std::lround(p.x()), v = std::lround(p.y());
    if (u < 0 || v < 0 || u >= frame.camera.width || v >= frame.camera.height) continue;
    const auto to = static_cast<std::size_t>(v * frame.camera.width + u);
    if (frame.depth_mm[to] != 0 && frame.depth_mm[to] <= t.z) continue;
    frame.depth_mm[to] = t.z;
    if (!gray.empty()) frame.intensity[to] = gray[t.index];
  }
}

std::string camera_text(const CameraIntrinsics& c) {
  char text[128];
  std::snprintf(text, sizeof text, "fx %.2f, fy %.2f, cx %.2f, cy %.2f", c.fx, c.fy, c.cx, c.cy);
  return text;
}

PointCloud read_cloud(const std::string& path, const FileKind& kind) {
  return kind.format == FileFormat::kPcd ? read_pcd(path) : read_ply(path);
}

}  // namespace

LoadedFrame frame_of_cloud(const std::string& path, const FileKind& kind, const FrameCamera& camera,
                           ImageBuffer<std::uint8_t> intensity, const DepthUnit& unit) {
  PointCloud cloud = read_cloud(path, kind);
  find_grid(path, cloud, camera.intrinsics, intensity);
  const std::vector<Sight> sights = measured_points(path, cloud);
  LoadedFrame frame;
  const bool fitted = !camera.intrinsics.valid();
  frame.camera = fitted ? fit_camera(path, cloud, sights) : camera.intrinsics;
  frame.camera.width = cloud.width;
  frame.camera.height = cloud.height;
  frame.roi = camera.roi;
  if (fitted && frame.camera.valid())
    frame.notes.push_back(path +
                          ": the camera was fitted to its points: " + camera_text(frame.camera));

  const Residuals bent = residuals_of(sights, frame.camera, camera.lens);
  if (!frame.camera.valid() || bent.half_px > kFitsShare * cloud.width) {
    throw DatasetError(
        path + ": its points do not lie on the rays of " +
        (fitted ? "any pinhole camera" : "the camera file's camera") + " (half of them are over " +
        std::to_string(std::lround(bent.half_px)) +
        " px off): expected are camera coordinates, x right, y down, z along the view, in the "
        "order of the image's rows" +
        (fitted ? "" : "; or the camera file is another camera's"));
  }
  std::vector<float> depths;
  for (const Sight& t : sights) depths.push_back(t.z);
  const FloatUnit found = unit_of_floats(path, depths, {unit.asked_for, {}});
  if (!found.note.empty()) frame.notes.push_back(found.note);

  const std::vector<std::uint8_t> gray =
      intensity.pixels.empty() ? std::move(cloud.gray) : std::move(intensity.pixels);
  frame.intensity = gray;
  frame.depth_mm.assign(cloud.points.size(), 0);
  if (residuals_of(sights, frame.camera, {}).most_px <= kOnRay_px) {
    for (const Sight& t : sights) frame.depth_mm[t.index] = t.z;
  } else {
    frame.notes.push_back(path + ": its points are projected into the image of a pinhole camera");
    if (!camera.lens.none()) undistort_intensity(path, camera.lens, frame);
    project(sights, camera.lens.none() ? gray : std::vector<std::uint8_t>{}, frame);
  }
  for (float& d : frame.depth_mm) d = float_depth_mm(d, found.mm);
  return frame;
}

}  // namespace binpick::drivers
