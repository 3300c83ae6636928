// The contour that is drawn from a trained model alone.
#include "overlay/model_contour.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/bracket.hpp"

namespace binpick::app {
namespace {

struct Box {
  double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
  void take(double x, double y) {
    x0 = std::min(x0, x), y0 = std::min(y0, y);
    x1 = std::max(x1, x), y1 = std::max(y1, y);
  }
};

// Of a part whose CAD has its origin in a corner.
TEST(ModelContour, LiesOnThePart) {
  const Pose pose = bracket_pose(10, 30, 20, {-30, 10, 500});
  const BracketScene scene = render_brackets(bracket_camera(), {pose});
  const float floor_mm = std::ranges::max(scene.depth_mm);
  Box part, contour;
  for (std::size_t i = 0; i < scene.depth_mm.size(); ++i) {
    const auto width = static_cast<std::size_t>(scene.camera.width);
    if (scene.depth_mm[i] < floor_mm)
      part.take(static_cast<double>(i % width), static_cast<double>(i / width));
  }
  for (const Vec2& p : contour_points_px(bracket_model(), scene.camera, pose))
    contour.take(p.x(), p.y());
  constexpr double kLimit_px = 5;  // the nearest trained viewpoint is some degrees off
  EXPECT_NEAR(contour.x0, part.x0, kLimit_px);
  EXPECT_NEAR(contour.x1, part.x1, kLimit_px);
  EXPECT_NEAR(contour.y0, part.y0, kLimit_px);
  EXPECT_NEAR(contour.y1, part.y1, kLimit_px);
}

}  // namespace
}  // namespace binpick::app
