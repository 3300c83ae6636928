#include "simulation/rasteriser.hpp"

#include <algorithm>
#include <cmath>

namespace binpick::simulation {
namespace {

constexpr double kNearMm = 10;

struct Projected {
  double u, v, inverse_z;
};

}  // namespace

View View::looking(const Vec3& from, const Vec3& to, double half_tangent, int size) {
  const Vec3 z = (to - from).normalized();
  const Vec3 side = std::abs(z.x()) < 0.8 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 y = z.cross(side).normalized();
  const Vec3 x = y.cross(z);
  View view;
  view.width = view.height = size;
  view.fx = view.fy = size / 2.0 / half_tangent;
  view.cx = view.cy = (size - 1) / 2.0;
  view.T_view_world.R << x.transpose(), y.transpose(), z.transpose();
  view.T_view_world.t_mm = -(view.T_view_world.R * from);
  return view;
}

View View::doubled() const {
  View view = *this;
  view.width *= 2;
  view.height *= 2;
  view.fx *= 2;
  view.fy *= 2;
  view.cx = 2 * cx + 0.5;
  view.cy = 2 * cy + 0.5;
  return view;
}

Vec3 View::ray(double u, double v) const {
  return T_view_world.R.transpose() * Vec3((u - cx) / fx, (v - cy) / fy, 1);
}

ZBuffer::ZBuffer(int w, int h)
    : width(w),
      height(h),
      inverse_z(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0.0f),
      triangle(inverse_z.size(), -1) {}

void ZBuffer::clear() {
  std::fill(inverse_z.begin(), inverse_z.end(), 0.0f);
  std::fill(triangle.begin(), triangle.end(), -1);
}

void rasterise(const TriangleSoup& soup, int first, int last, const View& view, ZBuffer& buffer) {
  for (int t = first; t < last; ++t) {
    std::array<Projected, 3> p{};
    bool behind = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 at =
          view.T_view_world * soup.corners[static_cast<std::size_t>(t)][k].cast<double>();
      behind = behind || at.z() < kNearMm;
      p[k] = {view.fx * at.x() / at.z() + view.cx, view.fy * at.y() / at.z() + view.cy, 1 / at.z()};
    }
    if (behind) continue;
    double area = (p[1].u - p[0].u) * (p[2].v - p[0].v) - (p[1].v - p[0].v) * (p[2].u - p[0].u);
    if (std::abs(area) < 1e-12) continue;
    if (area < 0) {
      std::swap(p[1], p[2]);
      area = -area;
    }
    const auto [u_min, u_max] = std::minmax({p[0].u, p[1].u, p[2].u});
    const auto [v_min, v_max] = std::minmax({p[0].v, p[1].v, p[2].v});
    if (u_max < 0 || v_max < 0 || u_min > buffer.width - 1 || v_min > buffer.height - 1) continue;
    const int x0 = static_cast<int>(std::ceil(std::max(u_min, 0.0)));
    const int x1 = static_cast<int>(std::floor(std::min(u_max, buffer.width - 1.0)));
    const int y0 = static_cast<int>(std::ceil(std::max(v_min, 0.0)));
    const int y1 = static_cast<int>(std::floor(std::min(v_max, buffer.height - 1.0)));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const double w0 = (p[2].u - p[1].u) * (y - p[1].v) - (p[2].v - p[1].v) * (x - p[1].u);
        const double w1 = (p[0].u - p[2].u) * (y - p[2].v) - (p[0].v - p[2].v) * (x - p[2].u);
        const double w2 = area - w0 - w1;
        if (w0 < 0 || w1 < 0 || w2 < 0) continue;
        const auto inverse_z = static_cast<float>(
            (w0 * p[0].inverse_z + w1 * p[1].inverse_z + w2 * p[2].inverse_z) / area);
        const std::size_t at = buffer.index(x, y);
        if (inverse_z > buffer.inverse_z[at]) {
          buffer.inverse_z[at] = inverse_z;
          buffer.triangle[at] = t;
        }
      }
    }
  }
}

ShadowMap::ShadowMap(const TriangleSoup& soup, const View& view)
    : view_(view), buffer_(view.width, view.height) {
  rasterise(soup, 0, soup.count(), view_, buffer_);
}

float ShadowMap::visibility(const Vec3& p_world, double bias_mm) const {
  const Vec3 p = view_.T_view_world * p_world;
  const double u = view_.fx * p.x() / p.z() + view_.cx;
  const double v = view_.fy * p.y() / p.z() + view_.cy;
  if (p.z() <= 0 || u < 0 || v < 0 || u >= view_.width - 1 || v >= view_.height - 1) return 1;
  const int x = static_cast<int>(u);
  const int y = static_cast<int>(v);
  const auto a = static_cast<float>(u - x);
  const auto b = static_cast<float>(v - y);
  const auto limit = static_cast<float>(1 / std::max(p.z() - bias_mm, 1.0));
  const auto seen = [&](int dx, int dy) {
    return buffer_.inverse_z[buffer_.index(x + dx, y + dy)] <= limit ? 1.0f : 0.0f;
  };
  return (1 - b) * ((1 - a) * seen(0, 0) + a * seen(1, 0)) +
         b * ((1 - a) * seen(0, 1) + a * seen(1, 1));
}

}  // namespace binpick::simulation
