#include "train/view_samples.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <memory>

#include "features/pyramid.hpp"
#include "simd/surface_slope.hpp"

namespace binpick::train {
namespace {

constexpr double kDiameterPx = 224;  // the part's size in these renderings

struct EdgePixel {
  int x, y;
  Vec3 position_cam;
  bool is_silhouette;
};

// Whether the faces of two neighbouring pixels of one surface meet at a sharp angle here.
bool is_crease(const RenderedView& view, int x, int y) {
  const int w = view.width;
  const float z = view.depth_mm[y * w + x];
  const Eigen::Vector3f& n = view.normal_cam[y * w + x];
  constexpr float kCosCrease = 0.819f;  // 35 degrees
  bool sharp = false;
  for (const auto& [i, j] :
       {std::pair{1, 0}, std::pair{0, 1}, std::pair{-1, 0}, std::pair{0, -1}}) {
    const int at = (y + j) * w + x + i;
    if (!(view.depth_mm[at] > 0) || std::fabs(view.depth_mm[at] - z) > z * kSameSurfaceRatio)
      return false;
    sharp |= n.dot(view.normal_cam[at]) < kCosCrease;
  }
  return sharp;
}

std::vector<EdgePixel> find_edges(const RenderedView& view, const CameraIntrinsics& camera) {
  std::vector<EdgePixel> edges;
  const auto depth = view.depth_view();
  for (int y = 1; y < view.height - 1; ++y) {
    for (int x = 1; x < view.width - 1; ++x) {
      const double z = static_cast<double>(depth.at(x, y));
      if (!(z > 0)) continue;
      const DepthStep step = depth_step(depth, x, y);
      if (step.edge) {
        // The outline runs between this pixel and the next: half a pixel further out.
        const double norm = std::hypot(static_cast<double>(step.gx), static_cast<double>(step.gy));
        const double u = x + 0.5 * static_cast<double>(step.gx) / norm,
                     v = y + 0.5 * static_cast<double>(step.gy) / norm;
        edges.push_back({x, y, camera.unproject(u, v, z), true});
      } else if (is_crease(view, x, y)) {
        edges.push_back({x, y, camera.unproject(x, y, z), false});
      }
    }
  }
  return edges;
}

// Direction of the edge through `at`: principal axis of the edge pixels of the same kind around it,
// in 3D. False where they form a blob or a corner rather than a line.
bool edge_tangent(const EdgePixel& at, const std::vector<EdgePixel>& edges, Vec3& tangent) {
  Mat3 scatter = Mat3::Zero();
  Vec3 mean = Vec3::Zero();
  int count = 0;
  std::vector<Vec3> near;
  for (const EdgePixel& e : edges) {
    if (std::abs(e.x - at.x) > 5 || std::abs(e.y - at.y) > 5 || e.is_silhouette != at.is_silhouette)
      continue;
    if (std::abs(e.position_cam.z() - at.position_cam.z()) > 0.01 * at.position_cam.z()) continue;
    near.push_back(e.position_cam);
    mean += e.position_cam;
    ++count;
  }
  if (count < 5) return false;
  mean /= count;
  for (const Vec3& p : near) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(scatter);
  if (solver.eigenvalues()[1] > 0.2 * solver.eigenvalues()[2]) return false;
  tangent = solver.eigenvectors().col(2);
  return true;
}

// Indices of at most `budget` edge pixels of one kind, spread evenly.
std::vector<int> spread(const std::vector<EdgePixel>& edges, bool silhouettes, int budget) {
  std::vector<int> of_kind, taken;
  for (int i = 0; i < static_cast<int>(edges.size()); ++i) {
    if (edges[i].is_silhouette == silhouettes) of_kind.push_back(i);
  }
  for (int distance = 2;; ++distance) {
    taken.clear();
    for (int i : of_kind) {
      bool clear = true;
      for (int k : taken) {
        const int dx = edges[i].x - edges[k].x, dy = edges[i].y - edges[k].y;
        if (dx * dx + dy * dy < distance * distance) {
          clear = false;
          break;
        }
      }
      if (clear) taken.push_back(i);
    }
    if (static_cast<int>(taken.size()) <= budget) return taken;
  }
}

// The normal as the sensor shows it: a fit over a patch, in which threads and knurls are averaged
// out. `radius_px` is the size of the detector's own patch at this rendering's scale.
Vec3 patch_normal(const RenderedView& view, int x, int y, int radius_px) {
  const float z = view.depth_mm[static_cast<std::size_t>(y) * view.width + x];
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (int j = std::max(0, y - radius_px); j <= std::min(view.height - 1, y + radius_px); ++j) {
    for (int i = std::max(0, x - radius_px); i <= std::min(view.width - 1, x + radius_px); ++i) {
      const std::size_t at = static_cast<std::size_t>(j) * view.width + i;
      if (view.depth_mm[at] > 0 && std::fabs(view.depth_mm[at] - z) <= z * kSameSurfaceRatio)
        sum += view.normal_cam[at];
    }
  }
  return sum.normalized().cast<double>();
}

void store(const Vec3& v, float* out) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(v[i]);
}

// The order of their indices' reversed bits: of what was listed row by row, a prefix is spread
// evenly.
std::vector<PointSample> bit_reversed(const std::vector<PointSample>& samples) {
  std::size_t all = 1;
  while (all < samples.size()) all *= 2;
  std::vector<PointSample> out;
  out.reserve(samples.size());
  for (std::size_t i = 0; i < all; ++i) {
    std::size_t reversed = 0;
    for (std::size_t bit = 1; bit < all; bit *= 2) reversed = 2 * reversed + ((i & bit) != 0);
    if (reversed < samples.size()) out.push_back(samples[reversed]);
  }
  return out;
}

ViewSamples sample_view(const RenderedView& view, const CameraIntrinsics& camera,
                        const Pose& T_cam_obj, int patch_radius_px) {
  ViewSamples out;
  const Pose T_obj_cam = T_cam_obj.inverse();
  const auto depth = view.depth_view();
  std::size_t visible = 0;
  for (float z : view.depth_mm) visible += z > 0;
  const int stride = std::max(
      1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(visible) / kSurfaceSamplesMax))));
  for (int y = 1 + stride / 2; y < view.height - 1; y += stride) {
    for (int x = 1 + stride / 2; x < view.width - 1; x += stride) {
      if (!(depth.at(x, y) > 0) || depth_step(depth, x, y).edge) continue;
      if (static_cast<int>(out.surface.size()) == kSurfaceSamplesMax) break;
      PointSample s{};
      store(T_obj_cam * camera.unproject(x, y, static_cast<double>(depth.at(x, y))), s.position_mm);
      store(T_obj_cam.R * patch_normal(view, x, y, patch_radius_px), s.direction);
      out.surface.push_back(s);
    }
  }
  out.surface = bit_reversed(out.surface);
  const double pixel_mm = T_cam_obj.t_mm.z() / camera.fx;
  out.sample_area_mm2 = stride * stride * pixel_mm * pixel_mm;
  const std::vector<EdgePixel> edges = find_edges(view, camera);
  for (const bool silhouettes : {true, false}) {
    for (int i : spread(edges, silhouettes, silhouettes ? kOutlineSamplesMax : kCreaseSamplesMax)) {
      Vec3 tangent;
      if (!edge_tangent(edges[i], edges, tangent)) continue;
      PointSample c{};
      store(T_obj_cam * edges[i].position_cam, c.position_mm);
      store(T_obj_cam.R * tangent, c.direction);
      out.contour.push_back(c);
      out.outline_count += silhouettes;
    }
  }
  return out;
}

}  // namespace

std::vector<ViewSamples> make_view_samples(const Mesh& centred_mesh, const PoseTree& tree,
                                           const TemplateCamera& camera, WorkerPool& pool) {
  const auto& leaves = tree.leaves().viewpoints;
  const double scale = kDiameterPx / (2.0 * camera.radius);
  const int size = static_cast<int>(std::ceil(kDiameterPx)) + 8;
  CameraIntrinsics intrinsics = camera.intrinsics;
  intrinsics.width = intrinsics.height = size;
  intrinsics.fx *= scale;
  intrinsics.fy *= scale;
  intrinsics.cx = intrinsics.cy = size / 2;
  // Two pixels of the level at which the detector fits its planes.
  const double feature_level_focal =
      camera.intrinsics.fx * std::exp2(camera.base_level - kFeatureLevel);
  const int patch_radius_px =
      std::max(1, static_cast<int>(std::lround(2 * intrinsics.fx / feature_level_focal)));
  std::vector<ViewSamples> out(leaves.size());
  std::vector<std::unique_ptr<Renderer>> renderers(static_cast<std::size_t>(pool.thread_count()));
  std::vector<RenderedView> views(static_cast<std::size_t>(pool.thread_count()));
  pool.parallel_for(static_cast<int>(leaves.size()), [&](int i, int thread) {
    if (!renderers[thread])
      renderers[thread] = std::make_unique<Renderer>(centred_mesh, size, size);
    const Pose T{leaves[i].R_view_obj, Vec3(0, 0, camera.reference_distance_mm)};
    renderers[thread]->render(intrinsics, T, views[thread]);
    out[i] = sample_view(views[thread], intrinsics, T, patch_radius_px);
  });
  return out;
}

}  // namespace binpick::train
