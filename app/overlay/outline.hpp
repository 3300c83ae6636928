// The visible edges of a rendered part: its silhouette, the jumps of depth inside it and its sharp
// creases.
#pragma once

#include <cstdint>
#include <vector>

#include "binpick/train/renderer.hpp"

namespace binpick::app {

// Coverage 0..255 of each pixel by edge lines; a rectangle of the image.
struct OutlineMask {
  int x = 0, y = 0, width = 0, height = 0;
  std::vector<std::uint8_t> coverage;
};

// Renders the part at the pose, finer than the image, and draws its edges `line_px` wide. Empty
// where the part is outside the image or behind the camera.
class OutlineDrawer {
 public:
  // `mesh` outlives the drawer. Throws RenderError.
  OutlineDrawer(const train::Mesh& mesh, const CameraIntrinsics& camera);

  OutlineMask draw(const Pose& T_cam_obj, double line_px);

 private:
  const train::Mesh& mesh_;
  CameraIntrinsics camera_;
  train::Renderer renderer_;
  train::RenderedView view_;
};

}  // namespace binpick::app
