// What both peers need around their search: clouds of what is seen, OpenCV's ICP, and a check of
// the pose against the depth image, since neither peer brings one.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "binpick/drivers/loaded_frame.hpp"
#include "binpick/train/renderer.hpp"

namespace binpick::peers {

struct ScoredPose {
  Pose T_cam_obj;
  double score = 0;
};

// Points as OpenCV has them: position and normal, in camera axes.
using Cloud = std::vector<cv::Vec6f>;
inline cv::Mat matrix_of(const Cloud& cloud) {
  return cv::Mat(cloud, true).reshape(1);
}

// Every `step`-th pixel in x and y.
Cloud cloud_of(const train::RenderedView& view, const CameraIntrinsics& camera, int step);
// The same of the frame's region; normals are those of the plane through four neighbours.
Cloud cloud_of(const drivers::LoadedFrame& frame, int step);

class PoseRefiner {
 public:
  PoseRefiner(const train::Mesh& mesh, const CameraIntrinsics& camera);

  // Moves each pose along its ray to the measured depth, aligns it with the scene, scores it by the
  // depth image, and leaves out those that are near a better one. Best first.
  std::vector<ScoredPose> refine(const std::vector<Pose>& poses, const drivers::LoadedFrame& frame,
                                 const Cloud& scene);

  double diameter_mm() const { return diameter_mm_; }
  const train::RenderedView& render(const CameraIntrinsics& camera, const Pose& T_cam_obj);

 private:
  // Alignment may throw a pose away, or make it no number.
  bool in_front(const Pose& T_cam_obj) const { return T_cam_obj.t_mm.z() > diameter_mm_; }
  // The part of the image that shows a sphere about the part.
  CameraIntrinsics window(const Pose& T_cam_obj) const;
  Pose aligned(const Pose& T_cam_obj, const Cloud& scene);
  // `visit(rendered, measured)` for each pixel of the part inside the image, in mm.
  template <class Visit>
  void compare(const Pose& T_cam_obj, const drivers::LoadedFrame& frame, Visit&& visit);
  Pose moved_to_surface(const Pose& T_cam_obj, const drivers::LoadedFrame& frame);
  double score(const Pose& T_cam_obj, const drivers::LoadedFrame& frame);

  CameraIntrinsics camera_;
  double diameter_mm_;
  train::Renderer renderer_;
  train::RenderedView view_;
};

}  // namespace binpick::peers
