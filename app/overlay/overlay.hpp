// Pictures of what was found: the gray image with the outline of every pose, its axes and its
// score. Thread: any; one picture at a time.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "binpick/model/object_model.hpp"
#include "binpick/train/mesh.hpp"
#include "overlay/picture.hpp"

namespace binpick::app {

class OutlineDrawer;

enum class OverlayStyle {
  kInstance,   // a colour of its own, axes, score
  kTruth,      // thin and white, nothing else
  kRight,      // green, score
  kFalsePick,  // red, axes, score
  kMiss,       // amber, label
  kNeutral,    // gray, score
};

struct OverlayItem {
  Pose T_cam_obj;
  const train::Mesh* mesh = nullptr;
  std::optional<double> score;
  std::string label;
  OverlayStyle style = OverlayStyle::kInstance;
  const ObjectModel* model = nullptr;  // where there is no mesh: its contour points are drawn
};

// A bright colour that differs from those of nearby indices; the same for the same index.
Colour instance_colour(int index);
Colour style_colour(OverlayStyle style, int index);

// What to draw on: the gray image, or the depth in colours where the sensor has no intensity.
Picture background_of(const Frame& frame);

class OverlayPainter {
 public:
  explicit OverlayPainter(const CameraIntrinsics& camera);
  ~OverlayPainter();
  OverlayPainter(const OverlayPainter&) = delete;
  OverlayPainter& operator=(const OverlayPainter&) = delete;

  // Draws all items on the picture, which has the camera's size; the first item comes out on top.
  // The meshes outlive the painter, which keeps a renderer for each. Throws RenderError.
  Picture paint(Picture picture, const std::vector<OverlayItem>& items);

 private:
  double diameter_of(const OverlayItem& item) const;
  void paint_contour(const OverlayItem& item, Colour colour, Picture& picture);
  void paint_outline(const OverlayItem& item, Colour colour, Picture& picture);

  CameraIntrinsics camera_;
  std::map<const train::Mesh*, std::unique_ptr<OutlineDrawer>> drawers_;
  std::map<const train::Mesh*, double> diameter_mm_;
};

}  // namespace binpick::app
