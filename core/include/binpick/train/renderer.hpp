// Off-screen rendering of one mesh: depth, normals and visibility as a pinhole camera sees them.
// Behind this header stands OSMesa; nothing else knows. Thread: one renderer per thread.
#pragma once

#include <memory>
#include <vector>

#include "binpick/frame/image_view.hpp"
#include "binpick/geometry/camera_model.hpp"
#include "binpick/train/mesh.hpp"

namespace binpick::train {

struct RenderedView {
  int width = 0, height = 0;
  std::vector<float> depth_mm;              // z of the surface, 0 where the ray misses the object
  std::vector<Eigen::Vector3f> normal_cam;  // face normal in camera axes, unit, towards the camera

  ImageView<const float> depth_view() const { return {depth_mm.data(), width, height, width}; }
};

class Renderer {
 public:
  // Throws RenderError when no off-screen context can be made.
  Renderer(const Mesh& mesh, int width_max, int height_max);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Renders the mesh at T_cam_obj into `out` (resized to camera.width x camera.height, at most the
  // maximum sizes). The camera is an exact pinhole with cx, cy anywhere, integer coordinates at
  // pixel centres. What is nearer than 1 mm to the camera's plane, or behind it, is cut away. The
  // same input gives the same bytes on every thread. Throws RenderError when memory runs out.
  void render(const CameraIntrinsics& camera, const Pose& T_cam_obj, RenderedView& out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace binpick::train
