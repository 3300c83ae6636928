#include "overlay/outline.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace binpick::app {
namespace {

constexpr int kFiner = 3;               // rendered pixels per image pixel, in each direction
constexpr int kMargin_px = 4;           // room for the line around the silhouette
constexpr float kCreaseCosine = 0.85f;  // faces that meet at more than 32 degrees
constexpr int kCrowdWindow_px = 9;
constexpr int kCrowdDensity = 36;  // of 255; one line across the window gives about 10 to 15
constexpr int kSpeckArea = 24;     // rendered pixels

// The rectangle of image pixels that the part can touch.
struct Box {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool empty() const { return x0 >= x1 || y0 >= y1; }
};

Box projected_box(const train::Mesh& mesh, const CameraIntrinsics& camera, const Pose& T_cam_obj) {
  double u0 = 1e300, v0 = 1e300, u1 = -1e300, v1 = -1e300;
  for (const Eigen::Vector3f& vertex : mesh.vertices_mm) {
    const Vec3 x = T_cam_obj * vertex.cast<double>();
    if (x.z() <= 1) return {0, 0, camera.width, camera.height};  // reaches the camera: anywhere
    const Vec2 p = camera.project(x);
    u0 = std::min(u0, p.x()), u1 = std::max(u1, p.x());
    v0 = std::min(v0, p.y()), v1 = std::max(v1, p.y());
  }
  const auto low = [](double v, int size) {
    return static_cast<int>(std::clamp(std::floor(v) - kMargin_px, 0.0, static_cast<double>(size)));
  };
  const auto high = [](double v, int size) {
    return static_cast<int>(
        std::clamp(std::ceil(v) + kMargin_px + 1, 0.0, static_cast<double>(size)));
  };
  return {low(u0, camera.width), low(v0, camera.height), high(u1, camera.width),
          high(v1, camera.height)};
}

// The camera that sees the box alone, each pixel split in kFiner x kFiner.
CameraIntrinsics finer_camera(const CameraIntrinsics& camera, const Box& box) {
  CameraIntrinsics fine;
  fine.width = (box.x1 - box.x0) * kFiner;
  fine.height = (box.y1 - box.y0) * kFiner;
  fine.fx = camera.fx * kFiner;
  fine.fy = camera.fy * kFiner;
  fine.cx = (camera.cx - box.x0 + 0.5) * kFiner - 0.5;
  fine.cy = (camera.cy - box.y0 + 0.5) * kFiner - 0.5;
  return fine;
}

enum class Edge : std::uint8_t { kNone, kCrease, kJump };

class EdgeTest {
 public:
  EdgeTest(const train::RenderedView& view, const CameraIntrinsics& camera)
      : view_(view), camera_(camera) {}

  Edge between(int x0, int y0, int x1, int y1) const {
    const std::size_t a = index(x0, y0), b = index(x1, y1);
    const float za = view_.depth_mm[a], zb = view_.depth_mm[b];
    if ((za > 0) != (zb > 0)) return Edge::kJump;
    if (!(za > 0)) return Edge::kNone;
    // Neither pixel lies on the plane of the other's face.
    if (off_plane(a, x0, y0, b, x1, y1) && off_plane(b, x1, y1, a, x0, y0)) return Edge::kJump;
    const bool crease = view_.normal_cam[a].dot(view_.normal_cam[b]) < kCreaseCosine;
    return crease ? Edge::kCrease : Edge::kNone;
  }

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * view_.width + x; }

  Eigen::Vector3f point(std::size_t i, int x, int y) const {
    return camera_.unproject(x, y, view_.depth_mm[i]).cast<float>();
  }

  bool off_plane(std::size_t a, int xa, int ya, std::size_t b, int xb, int yb) const {
    const float pixel_mm = view_.depth_mm[a] / static_cast<float>(camera_.fx);
    const float distance = view_.normal_cam[a].dot(point(b, xb, yb) - point(a, xa, ya));
    return std::abs(distance) > 3 * pixel_mm;
  }

  const train::RenderedView& view_;
  const CameraIntrinsics& camera_;
};

// Threads, knurls and finely tessellated bends give more creases than a picture can hold: takes
// away those that crowd each other, and specks.
void thin_out_creases(cv::Mat& creases) {
  cv::Mat density;
  cv::boxFilter(creases, density, CV_8U, {kCrowdWindow_px * kFiner, kCrowdWindow_px * kFiner});
  creases.setTo(0, density > kCrowdDensity);
  cv::Mat labels, stats, centroids;
  const int count = cv::connectedComponentsWithStats(creases, labels, stats, centroids, 8, CV_32S);
  for (int y = 0; y < creases.rows; ++y) {
    for (int x = 0; x < creases.cols; ++x) {
      const int label = labels.at<int>(y, x);
      if (label > 0 && label < count && stats.at<int>(label, cv::CC_STAT_AREA) < kSpeckArea) {
        creases.at<std::uint8_t>(y, x) = 0;
      }
    }
  }
}

}  // namespace

OutlineDrawer::OutlineDrawer(const train::Mesh& mesh, const CameraIntrinsics& camera)
    : mesh_(mesh),
      camera_(camera),
      renderer_(mesh, camera.width * kFiner, camera.height * kFiner) {}

OutlineMask OutlineDrawer::draw(const Pose& T_cam_obj, double line_px) {
  const Box box = projected_box(mesh_, camera_, T_cam_obj);
  if (box.empty() || T_cam_obj.t_mm.z() <= 0) return {};
  const CameraIntrinsics fine = finer_camera(camera_, box);
  renderer_.render(fine, T_cam_obj, view_);

  cv::Mat edges(view_.height, view_.width, CV_8U, cv::Scalar(0));
  cv::Mat creases = edges.clone();
  const EdgeTest test(view_, fine);
  for (int y = 0; y + 1 < view_.height; ++y) {
    for (int x = 0; x + 1 < view_.width; ++x) {
      const Edge edge = std::max(test.between(x, y, x + 1, y), test.between(x, y, x, y + 1));
      if (edge == Edge::kJump) edges.at<std::uint8_t>(y, x) = 255;
      if (edge == Edge::kCrease) creases.at<std::uint8_t>(y, x) = 255;
    }
  }
  thin_out_creases(creases);
  edges |= creases;
  const int pen = std::max(1, static_cast<int>(std::lround(line_px * kFiner)));
  cv::dilate(edges, edges, cv::getStructuringElement(cv::MORPH_ELLIPSE, {pen, pen}));
  cv::Mat mask;
  cv::resize(edges, mask, {box.x1 - box.x0, box.y1 - box.y0}, 0, 0, cv::INTER_AREA);
  return {
      box.x0, box.y0, mask.cols, mask.rows, {mask.begin<std::uint8_t>(), mask.end<std::uint8_t>()}};
}

}  // namespace binpick::app
