#include "train/sample_pool.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "binpick/geometry/angle.hpp"
#include "binpick/train/errors.hpp"
#include "simd/surface_slope.hpp"
#include "train/random.hpp"

namespace binpick::train {
namespace {

constexpr double kLeafDiameterPxMax = 100;
// With the margin a radius of at most 128 px: features store their offset in a signed byte.
constexpr double kReachPxMax = 125;
constexpr double kDiameterPxMin = 12;
// Narrower than this at the top of the pyramid, a part has no shape left: the scan starts one depth
// further down. (Not further: the cost of a scan grows sixteenfold per depth.)
constexpr double kScanWidthPxMin = 10;
// Faces that meet at more than this angle show as an edge in the intensity image.
const float kCreaseStep = 2 * std::sin(17.5f * static_cast<float>(kDegree));

// Gradient direction of the normals at a crease (structure tensor over the three components), if
// there is one.
bool crease_angle(const RenderedView& view, int x, int y, float& angle_rad) {
  const int w = view.width;
  const float z = view.depth_mm[y * w + x];
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      const float zn = view.depth_mm[(y + j) * w + x + i];
      if (!(zn > 0) || std::fabs(zn - z) > z * kSameSurfaceRatio) return false;
    }
  }
  auto n = [&](int i, int j) -> const Eigen::Vector3f& {
    return view.normal_cam[(y + j) * w + x + i];
  };
  const Eigen::Vector3f gx =
      (n(1, -1) + 2 * n(1, 0) + n(1, 1)) - (n(-1, -1) + 2 * n(-1, 0) + n(-1, 1));
  const Eigen::Vector3f gy =
      (n(-1, 1) + 2 * n(0, 1) + n(1, 1)) - (n(-1, -1) + 2 * n(0, -1) + n(1, -1));
  const float xx = gx.squaredNorm(), yy = gy.squaredNorm(), xy = gx.dot(gy);
  if (xx + yy < 16 * kCreaseStep * kCreaseStep) return false;
  angle_rad = 0.5f * std::atan2(2 * xy, xx - yy);
  return true;
}

// No rendering farther than this from a viewpoint lies within its jitter, a square of tilts.
double reach_cos(double tilt_jitter_deg) {
  return std::cos(std::min(1.5 * tilt_jitter_deg * kDegree, kPi));
}

void thin_surface(int first, RenderedSample& sample) {
  std::vector<SurfacePoint> kept;
  kept.reserve(sample.surface.size() / kPooledSurfaceStride + 1);
  for (std::size_t i = static_cast<std::size_t>(first); i < sample.surface.size();
       i += kPooledSurfaceStride) {
    kept.push_back(sample.surface[i]);
  }
  sample.surface = std::move(kept);
  sample.contour.shrink_to_fit();
}

}  // namespace

TemplateCamera make_template_camera(const TrainOptions& options, const MeshBounds& bounds) {
  TemplateCamera out;
  const double diameter_mm = bounds.diameter_mm;
  // The geometric mean: as far, in scale, from the nearest distance as from the farthest.
  out.reference_distance_mm = std::sqrt(options.distance_min_mm * options.distance_max_mm);
  const double nearest = out.reference_distance_mm - options.distance_jitter_mm - diameter_mm / 2;
  if (nearest < diameter_mm / 4) {
    throw TrainError("the part (diameter " + std::to_string(diameter_mm) +
                     " mm) is too large for the distance range: the camera would be inside it");
  }
  const double focal = std::sqrt(options.camera.fx * options.camera.fy);
  const double diameter_px = focal * diameter_mm / out.reference_distance_mm;
  if (diameter_px < kDiameterPxMin) {
    throw TrainError("the part spans only " + std::to_string(diameter_px) +
                     " px at the reference distance; at least 12 are needed");
  }
  const double reach_px = focal * diameter_mm / 2 / nearest;  // of the part at its nearest
  while (diameter_px / (1 << out.base_level) > kLeafDiameterPxMax ||
         reach_px / (1 << out.base_level) > kReachPxMax) {
    ++out.base_level;
  }
  const double f = focal / (1 << out.base_level);
  out.radius = static_cast<int>(std::ceil(reach_px / (1 << out.base_level))) + 3;
  out.radius = (out.radius + 7) / 8 * 8;
  Vec3 extents = bounds.max_mm - bounds.min_mm;
  std::sort(extents.data(), extents.data() + 3);
  const double width_px = f * extents[1] / out.reference_distance_mm;
  const int leaf = options.tree_depths - 1;
  if (leaf > 1 && width_px / (1 << leaf) < kScanWidthPxMin) out.scan_depth = 1;
  const int size = 2 * out.radius;
  out.intrinsics = {
      size, size, f, f, static_cast<double>(out.radius), static_cast<double>(out.radius)};
  return out;
}

void extract_features(const RenderedView& view, const CameraIntrinsics& camera,
                      RenderedSample& out) {
  out.contour.clear();
  out.surface.clear();
  const auto depth = view.depth_view();
  const float cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  for (int y = 2; y < view.height - 2; ++y) {
    for (int x = 2; x < view.width - 2; ++x) {
      if (!(depth.at(x, y) > 0)) continue;
      const float px = static_cast<float>(x) - cx, py = static_cast<float>(y) - cy;
      const DepthStep step = depth_step(depth, x, y);
      float angle = 0;
      if (step.edge) {
        // A Sobel filter answers on both sides of an outline: one pixel here, one beyond it.
        angle = std::atan2(step.gy, step.gx);
        out.contour.push_back({px, py, angle});
        out.contour.push_back(
            {px + std::round(std::cos(angle)), py + std::round(std::sin(angle)), angle});
      } else if (crease_angle(view, x, y, angle)) {
        out.contour.push_back({px, py, angle});
      }
      const RayNormal n = fit_ray_normal(depth, camera, x, y);
      if (n.valid)
        out.surface.push_back({px, py, std::sqrt(n.x * n.x + n.y * n.y), std::atan2(n.y, n.x)});
    }
  }
}

std::vector<RenderedSample> make_sample_pool(const Mesh& centred_mesh, const TrainOptions& options,
                                             const PoseTree& tree, const TemplateCamera& camera,
                                             int count, WorkerPool& pool,
                                             const TrainProgress& progress) {
  // Even cover of the sphere: the golden-angle spiral, in an order that is shuffled by the seed so
  // that any run of indices is spread over the sphere too.
  std::vector<int> order(count);
  for (int i = 0; i < count; ++i) order[i] = i;
  for (int i = count - 1; i > 0; --i) {
    std::swap(order[i], order[static_cast<int>(hashed_uniform(options.seed, i) * (i + 1))]);
  }
  // Leaves lie up to half their spacing beyond the limit, the corners of their jitter 1.42 further.
  const double leaf_spacing_deg = 63.4 / (1 << (options.tree_depths - 1));
  const double beyond_deg = std::max(8.0, leaf_spacing_deg / 2) + 1.5 * options.tilt_jitter_deg;
  const double tilt_limit = std::min(180.0, options.tilt_max_deg + beyond_deg) * kDegree;
  const auto taken = [&](const Vec3& direction) {
    const auto& leaves = tree.leaves().viewpoints;
    return std::any_of(leaves.begin(), leaves.end(), [&](const TreeViewpoint& v) {
      return v.direction_obj.dot(direction) >= reach_cos(options.tilt_jitter_deg);
    });
  };
  std::vector<RenderedSample> samples;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * order[i] + 1) / count;
    const double turn = order[i] * kPi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    if (z < std::cos(tilt_limit) - 1e-12) continue;
    RenderedSample s;
    s.direction_obj = Vec3(r * std::cos(turn), r * std::sin(turn), z);
    if (!taken(s.direction_obj)) continue;
    const Mat3 front =
        (Mat3() << 1, 0, 0, 0, -1, 0, 0, 0, -1).finished();  // camera above +z, looking down
    s.R_view_obj = front * rotation_between(s.direction_obj, Vec3::UnitZ());
    s.distance_mm =
        camera.reference_distance_mm +
        options.distance_jitter_mm * (2 * hashed_uniform(options.seed + 1, order[i]) - 1);
    samples.push_back(std::move(s));
  }

  std::vector<std::unique_ptr<Renderer>> renderers(pool.thread_count());
  std::vector<RenderedView> views(pool.thread_count());
  const int size = camera.intrinsics.width;
  pool.parallel_for(static_cast<int>(samples.size()), [&](int i, int thread) {
    if (!renderers[thread])
      renderers[thread] = std::make_unique<Renderer>(centred_mesh, size, size);
    RenderedSample& s = samples[i];
    renderers[thread]->render(camera.intrinsics, {s.R_view_obj, Vec3(0, 0, s.distance_mm)},
                              views[thread]);
    extract_features(views[thread], camera.intrinsics, s);
    thin_surface(i % kPooledSurfaceStride, s);
    if (progress && thread == 0)
      progress(static_cast<double>(i) / static_cast<double>(samples.size()));
  });
  return samples;
}

std::vector<AlignedSample> samples_near(const TreeViewpoint& view,
                                        const std::vector<RenderedSample>& pool,
                                        double tilt_jitter_deg) {
  std::vector<AlignedSample> near;
  const double jitter = tilt_jitter_deg * kDegree;
  const double cos_limit = reach_cos(tilt_jitter_deg);
  for (int i = 0; i < static_cast<int>(pool.size()); ++i) {
    const RenderedSample& s = pool[i];
    const double c = view.direction_obj.dot(s.direction_obj);
    if (c < cos_limit) continue;
    const Mat3 Q = rotation_between(view.direction_obj, s.direction_obj);
    const Vec3 tilt = view.R_view_obj * rotation_vector(Q);
    if (std::abs(tilt.x()) > jitter || std::abs(tilt.y()) > jitter) continue;
    // R_aligned = Rz(turn) R_sample, where R_aligned is the viewpoint's frame carried over to the
    // sample's direction.
    const Mat3 Z = view.R_view_obj * Q.transpose() * s.R_view_obj.transpose();
    near.push_back({i, static_cast<float>(std::atan2(Z(1, 0), Z(0, 0)))});
  }
  return near;
}

}  // namespace binpick::train
