#include "bench/peers/pose_refiner.hpp"

#include <algorithm>
#include <opencv2/surface_matching.hpp>

namespace binpick::peers {
namespace {

constexpr int kWindowMax_px = 640;
constexpr float kAgree_mm = 3;
constexpr double kScoreMin = 0.3;  // below it a pose is noise

void add_point(const Vec3& p, const Vec3& n, Cloud& cloud) {
  cv::Vec6f& point = cloud.emplace_back();
  for (int k = 0; k < 3; ++k) {
    point[k] = static_cast<float>(p[k]);
    point[k + 3] = static_cast<float>(n[k]);
  }
}

}  // namespace

Cloud cloud_of(const train::RenderedView& view, const CameraIntrinsics& camera, int step) {
  Cloud cloud;
  const ImageView<const float> depth = view.depth_view();
  const ImageView<const Eigen::Vector3f> normal{view.normal_cam.data(), view.width, view.height,
                                                view.width};
  for (int v = 0; v < view.height; v += step) {
    for (int u = 0; u < view.width; u += step) {
      const auto z = static_cast<double>(depth.at(u, v));
      if (z > 0) add_point(camera.unproject(u, v, z), normal.at(u, v).cast<double>(), cloud);
    }
  }
  return cloud;
}

Cloud cloud_of(const drivers::LoadedFrame& frame, int step) {
  constexpr int kReach_px = 4;
  constexpr float kOneSurface_mm = 4;
  Cloud cloud;
  const ImageView<const float> depth = frame.view().depth_mm;
  const auto z = [&](int u, int v) { return depth.at(u, v); };
  const PixelRange range = pixels_of(frame.roi, frame.camera.width, frame.camera.height);
  for (int v = range.y0 + kReach_px; v < range.y1 - kReach_px; v += step) {
    for (int u = range.x0 + kReach_px; u < range.x1 - kReach_px; u += step) {
      const auto near = [&](int du, int dv) {
        return z(u, v) > 0 && std::abs(z(u + du, v + dv) - z(u, v)) < kOneSurface_mm;
      };
      const auto point = [&](int du, int dv) {
        return frame.camera.unproject(u + du, v + dv, static_cast<double>(z(u + du, v + dv)));
      };
      const int r = kReach_px;
      if (!near(r, 0) || !near(-r, 0) || !near(0, r) || !near(0, -r)) continue;
      const Vec3 across = (point(0, r) - point(0, -r)).cross(point(r, 0) - point(-r, 0));
      add_point(point(0, 0), across.normalized(), cloud);
    }
  }
  return cloud;
}

PoseRefiner::PoseRefiner(const train::Mesh& mesh, const CameraIntrinsics& camera)
    : camera_(camera),
      diameter_mm_(train::mesh_bounds(mesh).diameter_mm),
      renderer_(mesh, kWindowMax_px, kWindowMax_px) {}

const train::RenderedView& PoseRefiner::render(const CameraIntrinsics& camera,
                                               const Pose& T_cam_obj) {
  renderer_.render(camera, T_cam_obj, view_);
  return view_;
}

CameraIntrinsics PoseRefiner::window(const Pose& T_cam_obj) const {
  const Vec2 middle = camera_.project(T_cam_obj.t_mm);
  const double radius = 0.55 * diameter_mm_ * camera_.fx / T_cam_obj.t_mm.z();
  CameraIntrinsics window = camera_;
  window.width = window.height = std::min(kWindowMax_px, 2 * static_cast<int>(radius) + 1);
  window.cx -= std::floor(middle.x() - radius);
  window.cy -= std::floor(middle.y() - radius);
  return window;
}

Pose PoseRefiner::aligned(const Pose& T_cam_obj, const Cloud& scene) {
  if (!in_front(T_cam_obj)) return T_cam_obj;
  const CameraIntrinsics camera = window(T_cam_obj);
  const Cloud model = cloud_of(render(camera, T_cam_obj), camera, 3);
  Cloud near;
  const double radius_mm = 0.55 * diameter_mm_;
  for (const cv::Vec6f& p : scene) {
    if ((Vec3(p[0], p[1], p[2]) - T_cam_obj.t_mm).norm() < radius_mm) near.push_back(p);
  }
  if (std::min(model.size(), near.size()) < 50) return T_cam_obj;
  double residual = 0;
  cv::Matx44d moved = cv::Matx44d::eye();
  cv::ppf_match_3d::ICP(50, 0.005f, 2.5f, 3)
      .registerModelToScene(matrix_of(model), matrix_of(near), residual, moved);
  Pose step;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) step.R(r, c) = moved(r, c);
    step.t_mm[r] = moved(r, 3);
  }
  return step * T_cam_obj;
}

template <class Visit>
void PoseRefiner::compare(const Pose& T_cam_obj, const drivers::LoadedFrame& frame, Visit&& visit) {
  if (!in_front(T_cam_obj)) return;
  const CameraIntrinsics camera = window(T_cam_obj);
  const train::RenderedView& view = render(camera, T_cam_obj);
  const ImageView<const float> measured = frame.view().depth_mm;
  const int left = static_cast<int>(std::lround(camera_.cx - camera.cx)),
            top = static_cast<int>(std::lround(camera_.cy - camera.cy));
  for (int v = 0; v < view.height; ++v) {
    for (int u = 0; u < view.width; ++u) {
      const float z = view.depth_view().at(u, v);
      const int x = u + left, y = v + top;
      if (z > 0 && measured.contains(x, y)) visit(z, measured.at(x, y));
    }
  }
}

// By the median of the differences.
Pose PoseRefiner::moved_to_surface(const Pose& T_cam_obj, const drivers::LoadedFrame& frame) {
  std::vector<float> farther_mm;
  compare(T_cam_obj, frame, [&](float rendered, float measured) {
    if (measured > 0) farther_mm.push_back(measured - rendered);
  });
  if (farther_mm.empty()) return T_cam_obj;
  const auto middle = farther_mm.begin() + static_cast<std::ptrdiff_t>(farther_mm.size() / 2);
  std::nth_element(farther_mm.begin(), middle, farther_mm.end());
  return {T_cam_obj.R, T_cam_obj.t_mm * (1 + static_cast<double>(*middle) / T_cam_obj.t_mm.z())};
}

// The share of the pixels that agree, less the share behind which something is measured.
double PoseRefiner::score(const Pose& T_cam_obj, const drivers::LoadedFrame& frame) {
  int seen = 0, agreeing = 0, behind = 0;
  compare(T_cam_obj, frame, [&](float rendered, float measured) {
    ++seen;
    if (measured == 0) return;
    agreeing += std::abs(measured - rendered) < kAgree_mm;
    behind += measured - rendered > kAgree_mm;
  });
  return seen > 0 ? std::max(0.0, static_cast<double>(agreeing - behind) / seen) : 0;
}

std::vector<ScoredPose> PoseRefiner::refine(const std::vector<Pose>& poses,
                                            const drivers::LoadedFrame& frame, const Cloud& scene) {
  std::vector<ScoredPose> refined, kept;
  for (const Pose& pose : poses) {
    // Twice: another pose shows another part of the surface.
    const Pose T = aligned(aligned(moved_to_surface(pose, frame), scene), scene);
    refined.push_back({T, score(T, frame)});
  }
  std::stable_sort(refined.begin(), refined.end(),
                   [](const ScoredPose& a, const ScoredPose& b) { return a.score > b.score; });
  for (const ScoredPose& pose : refined) {
    const bool repeated = std::any_of(kept.begin(), kept.end(), [&](const ScoredPose& better) {
      return (better.T_cam_obj.t_mm - pose.T_cam_obj.t_mm).norm() < 0.25 * diameter_mm_;
    });
    if (!repeated && pose.score > kScoreMin) kept.push_back(pose);
  }
  return kept;
}

}  // namespace binpick::peers
