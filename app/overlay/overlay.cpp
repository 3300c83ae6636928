#include "overlay/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "binpick/base/assert.hpp"
#include "overlay/model_contour.hpp"
#include "overlay/outline.hpp"

namespace binpick::app {
namespace {

constexpr double kAxisShare = 0.28;  // of the diameter
constexpr int kSubpixelBits = 4;     // OpenCV's fixed-point coordinates

cv::Scalar scalar(Colour c) {
  return {static_cast<double>(c.r), static_cast<double>(c.g), static_cast<double>(c.b)};
}

bool has_axes(OverlayStyle style) {
  return style == OverlayStyle::kInstance || style == OverlayStyle::kFalsePick;
}

bool has_shape(const OverlayItem& item) {
  return item.mesh != nullptr || item.model != nullptr;
}

double line_width_px(OverlayStyle style) {
  return style == OverlayStyle::kTruth ? 0.7 : 1.5;
}

cv::Point fixed_point(const Vec2& p) {
  return {static_cast<int>(std::lround(p.x() * (1 << kSubpixelBits))),
          static_cast<int>(std::lround(p.y() * (1 << kSubpixelBits)))};
}

// A line with a dark seam, so that it can be seen on any ground.
void draw_line(cv::Mat& image, const Vec2& a, const Vec2& b, Colour colour) {
  cv::line(image, fixed_point(a), fixed_point(b), cv::Scalar(0, 0, 0), 4, cv::LINE_AA,
           kSubpixelBits);
  cv::line(image, fixed_point(a), fixed_point(b), scalar(colour), 2, cv::LINE_AA, kSubpixelBits);
}

void draw_arrow(cv::Mat& image, const Vec2& from, const Vec2& to, Colour colour) {
  const Vec2 along = to - from;
  const double length = along.norm();
  if (length < 1) return;  // points at the camera
  const Vec2 back = -along / length * std::clamp(0.3 * length, 3.0, 8.0);
  const Vec2 side(-back.y(), back.x());
  draw_line(image, to, to + back + 0.5 * side, colour);
  draw_line(image, to, to + back - 0.5 * side, colour);
  draw_line(image, from, to, colour);
}

void draw_axes(cv::Mat& image, const CameraIntrinsics& camera, const Pose& T_cam_obj,
               double length_mm) {
  static constexpr Colour kAxisColours[3] = {{255, 64, 64}, {64, 224, 64}, {80, 128, 255}};
  const Vec2 origin = camera.project(T_cam_obj.t_mm);
  // The farthest tip first: what is nearer to the camera is drawn over it.
  int order[3] = {0, 1, 2};
  std::sort(order, order + 3, [&](int a, int b) { return T_cam_obj.R(2, a) > T_cam_obj.R(2, b); });
  for (const int axis : order) {
    const Vec3 tip = T_cam_obj.t_mm + length_mm * T_cam_obj.R.col(axis);
    if (tip.z() > 1) draw_arrow(image, origin, camera.project(tip), kAxisColours[axis]);
  }
}

std::string text_of(const OverlayItem& item) {
  char score[16] = "";
  if (item.score) std::snprintf(score, sizeof score, "%.2f", *item.score);
  return item.label + (item.label.empty() || !item.score ? "" : " ") + score;
}

void draw_text(cv::Mat& image, const std::string& text, const Vec2& at, Colour colour) {
  constexpr double kSize = 0.42;
  int baseline = 0;
  const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, kSize, 1, &baseline);
  cv::Point p(static_cast<int>(at.x()) + 6, static_cast<int>(at.y()) - 6);
  p.x = std::clamp(p.x, 2, std::max(2, image.cols - size.width - 2));
  p.y = std::clamp(p.y, size.height + 2, std::max(size.height + 2, image.rows - baseline - 2));
  cv::putText(image, text, p, cv::FONT_HERSHEY_SIMPLEX, kSize, cv::Scalar(0, 0, 0), 3, cv::LINE_AA);
  cv::putText(image, text, p, cv::FONT_HERSHEY_SIMPLEX, kSize, scalar(colour), 1, cv::LINE_AA);
}

Colour from_hsv(double hue, double saturation, double value) {
  const auto channel = [&](double offset) {
    const double k = std::fmod(offset + hue * 6, 6.0);
    const double v = value * (1 - saturation * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
    return static_cast<std::uint8_t>(std::lround(255 * v));
  };
  return {channel(5), channel(3), channel(1)};
}

}  // namespace

// The golden ratio spreads hues so that neighbours in the list are never alike.
Colour instance_colour(int index) {
  const double hue = std::fmod(0.11 + 0.618033988749895 * index, 1.0);
  return from_hsv(hue, index % 2 == 0 ? 0.85 : 0.6, 1.0);
}

Colour style_colour(OverlayStyle style, int index) {
  switch (style) {
    case OverlayStyle::kInstance:
      return instance_colour(index);
    case OverlayStyle::kTruth:
      return {255, 255, 255};
    case OverlayStyle::kRight:
      return {60, 220, 90};
    case OverlayStyle::kFalsePick:
      return {255, 60, 60};
    case OverlayStyle::kMiss:
      return {255, 190, 30};
    case OverlayStyle::kNeutral:
      return {150, 165, 185};
  }
  return {};
}

Picture background_of(const Frame& frame) {
  if (frame.intensity.empty()) return colour_map_depth(frame.depth_mm, frame.roi);
  return picture_from_gray(frame.intensity);
}

OverlayPainter::OverlayPainter(const CameraIntrinsics& camera) : camera_(camera) {}

OverlayPainter::~OverlayPainter() = default;

void OverlayPainter::paint_outline(const OverlayItem& item, Colour colour, Picture& picture) {
  std::unique_ptr<OutlineDrawer>& drawer = drawers_[item.mesh];
  if (!drawer) {
    drawer = std::make_unique<OutlineDrawer>(*item.mesh, camera_);
    diameter_mm_[item.mesh] = train::mesh_bounds(*item.mesh).diameter_mm;
  }
  const OutlineMask mask = drawer->draw(item.T_cam_obj, line_width_px(item.style));
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const int alpha = mask.coverage[static_cast<std::size_t>(y) * mask.width + x];
      if (alpha == 0) continue;
      std::uint8_t* p = picture.pixel(mask.x + x, mask.y + y);
      const std::uint8_t c[3] = {colour.r, colour.g, colour.b};
      for (int i = 0; i < 3; ++i)
        p[i] = static_cast<std::uint8_t>((p[i] * (255 - alpha) + c[i] * alpha) / 255);
    }
  }
}

// A dot for each contour sample: whether the edge runs on between two of them is not known.
void OverlayPainter::paint_contour(const OverlayItem& item, Colour colour, Picture& picture) {
  cv::Mat image(picture.height, picture.width, CV_8UC3, picture.rgb.data());
  for (const Vec2& p : contour_points_px(*item.model, camera_, item.T_cam_obj)) {
    const bool inside = p.x() > -1 && p.y() > -1 && p.x() < camera_.width && p.y() < camera_.height;
    if (!inside) continue;
    cv::circle(image, fixed_point(p), 1 << kSubpixelBits, scalar(colour), cv::FILLED, cv::LINE_AA,
               kSubpixelBits);
  }
}

double OverlayPainter::diameter_of(const OverlayItem& item) const {
  return item.mesh != nullptr ? diameter_mm_.at(item.mesh) : item.model->info().diameter_mm;
}

Picture OverlayPainter::paint(Picture picture, const std::vector<OverlayItem>& items) {
  BINPICK_ASSERT(picture.width == camera_.width && picture.height == camera_.height);
  cv::Mat image(picture.height, picture.width, CV_8UC3, picture.rgb.data());
  for (std::size_t k = items.size(); k-- > 0;) {
    const OverlayItem& item = items[k];
    const Colour colour = style_colour(item.style, static_cast<int>(k));
    if (item.mesh != nullptr) {
      paint_outline(item, colour, picture);
    } else if (item.model != nullptr) {
      paint_contour(item, colour, picture);
    }
  }
  // Text and arrows last: no outline crosses them.
  for (std::size_t k = items.size(); k-- > 0;) {
    const OverlayItem& item = items[k];
    if (!has_shape(item) || item.T_cam_obj.t_mm.z() <= 0 || !has_axes(item.style)) continue;
    draw_axes(image, camera_, item.T_cam_obj, kAxisShare * diameter_of(item));
  }
  for (std::size_t k = items.size(); k-- > 0;) {
    const OverlayItem& item = items[k];
    const std::string text = text_of(item);
    if (!has_shape(item) || item.T_cam_obj.t_mm.z() <= 0 || text.empty()) continue;
    if (item.style == OverlayStyle::kTruth) continue;
    draw_text(image, text, camera_.project(item.T_cam_obj.t_mm),
              style_colour(item.style, static_cast<int>(k)));
  }
  return picture;
}

}  // namespace binpick::app
