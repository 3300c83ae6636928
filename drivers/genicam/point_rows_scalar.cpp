#include <cmath>
#include <cstring>

#include "genicam/point_rows.hpp"

namespace binpick::drivers {
namespace {

// A point may lie this far from the centre of its pixel.
constexpr float kGridTolerance_px = 1.0f;

template <class T, int kChannels>
struct Codes {
  static float load(const std::uint8_t* points, int x, int channel) {
    T value;
    std::memcpy(&value, points + static_cast<std::size_t>(x * kChannels + channel) * sizeof(T),
                sizeof(T));
    return static_cast<float>(value);  // exact: 16 bits or a float
  }
};

// Calls with the codes that the points have.
template <class Call>
auto with_codes(PointLayout layout, Call&& call) {
  if (layout == PointLayout::kAbc32f) return call(Codes<float, 3>{});
  if (layout == PointLayout::kAbcy16) return call(Codes<std::uint16_t, 4>{});
  return call(Codes<std::uint16_t, 3>{});
}

}  // namespace

void point_depth_row_scalar(const PointAxes& axes, const std::uint8_t* points, int width,
                            float* depth_mm) {
  with_codes(axes.layout, [&](auto codes) {
    for (int x = 0; x < width; ++x)
      depth_mm[x] = axes.c.depth_mm(static_cast<double>(codes.load(points, x, 2)));
  });
}

bool points_on_rays_scalar(const PointAxes& axes, const std::uint8_t* points, int x_begin,
                           int width, int y, const float* depth_mm) {
  const float dv = static_cast<float>(y) - axes.cv;
  return with_codes(axes.layout, [&](auto codes) {
    bool on_rays = true;
    for (int x = x_begin; x < width; ++x) {
      const float z = depth_mm[x];
      const float u_times_z = axes.a.times_z(codes.load(points, x, 0));
      const float v_times_z = axes.b.times_z(codes.load(points, x, 1));
      const float error_u = std::abs(u_times_z - (static_cast<float>(x) - axes.cu) * z);
      const float error_v = std::abs(v_times_z - dv * z);
      const float limit = kGridTolerance_px * z;
      // Where there is no depth x and y mean nothing; where they are NaN the point is off its ray.
      on_rays &= !(z > 0) || (error_u <= limit && error_v <= limit);
    }
    return on_rays;
  });
}

void point_targets_row_scalar(const PointAxes& axes, const std::uint8_t* points, int x_begin,
                              int width, int y, int image_height, float* depth_mm,
                              std::int32_t* target) {
  const float u_end = static_cast<float>(width), v_end = static_cast<float>(image_height);
  const float corner_u = axes.cu + 0.5f, corner_v = axes.cv + 0.5f;
  with_codes(axes.layout, [&](auto codes) {
    for (int x = x_begin; x < width; ++x) {
      const float z = axes.c.depth_mm(static_cast<double>(codes.load(points, x, 2)));
      const float per_z = 1.0f / z;
      // From the outer corner of the first pixel on, so that whole parts are the pixel.
      const float u = axes.a.times_z(codes.load(points, x, 0)) * per_z + corner_u;
      const float v = axes.b.times_z(codes.load(points, x, 1)) * per_z + corner_v;
      // Written so that NaN is outside.
      const bool inside = z > 0 && u >= 0 && v >= 0 && u < u_end && v < v_end;
      target[x] = inside ? static_cast<std::int32_t>(v) * width + static_cast<std::int32_t>(u)
                         : y * width + x;
      depth_mm[x] = inside ? z : kNoPoint;
    }
  });
}

void point_gray_row_scalar(const std::uint8_t* points, int width, std::uint8_t* gray) {
  for (int x = 0; x < width; ++x) gray[x] = points[8 * x + 7];
}

}  // namespace binpick::drivers
