// A plain z-buffer rasteriser. It serves the camera, the lights' shadow maps and the truth alike,
// so that all of them see the same geometry.
#pragma once

#include <array>
#include <vector>

#include "binpick/geometry/pose.hpp"

namespace binpick::simulation {

// A pinhole view: u = fx x / z + cx, v = fy y / z + cy; integer (u, v) are pixel centres.
struct View {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  Pose T_view_world;

  // A square view of the given half-angle tangent from a point towards another.
  static View looking(const Vec3& from, const Vec3& to, double half_tangent, int size);
  // The same view with each pixel divided into 2 x 2.
  View doubled() const;
  Vec3 position() const { return T_view_world.inverse().t_mm; }
  // World direction of the ray through a pixel, with z = 1 along the view.
  Vec3 ray(double u, double v) const;
};

// World triangles with a normal per corner; body tells what each belongs to.
struct TriangleSoup {
  std::vector<std::array<Eigen::Vector3f, 3>> corners;
  std::vector<std::array<Eigen::Vector3f, 3>> normals;
  std::vector<int> body;
  int count() const { return static_cast<int>(body.size()); }
};

struct ZBuffer {
  int width = 0;
  int height = 0;
  std::vector<float> inverse_z;  // 0 where nothing is seen
  std::vector<int> triangle;     // -1 where nothing is seen

  ZBuffer(int w, int h);
  void clear();
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

// Draws triangles first .. last-1. A triangle that reaches behind the viewer is left out: bench and
// bin always lie in front.
void rasterise(const TriangleSoup& soup, int first, int last, const View& view, ZBuffer& buffer);

// Whether a point is seen from somewhere, e.g. lit by a light.
class ShadowMap {
 public:
  ShadowMap(const TriangleSoup& soup, const View& view);
  // 0 hidden .. 1 seen, interpolated between four map pixels; 1 outside the map.
  float visibility(const Vec3& p_world, double bias_mm) const;
  const View& view() const { return view_; }

 private:
  View view_;
  ZBuffer buffer_;
};

}  // namespace binpick::simulation
