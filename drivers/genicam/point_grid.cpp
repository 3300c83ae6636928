#include "genicam/point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace binpick::drivers {
namespace {

// A point may lie this far from the centre of its pixel.
constexpr float kGridTolerance_px = 1.0f;

template <class T, int kChannels>
struct Codes {
  using Value = T;
  static constexpr int kStrideBytes = kChannels * static_cast<int>(sizeof(T));
  static T load(const std::uint8_t* point, int channel) {
    T value;
    std::memcpy(&value, point + static_cast<std::size_t>(channel) * sizeof(T), sizeof(T));
    return value;
  }
};

// Calls with the codes that the part's format has.
template <class Call>
auto with_codes(PixelFormat format, Call&& call) {
  if (format == PixelFormat::kCoord3dAbc32f) return call(Codes<float, 3>{});
  if (format == PixelFormat::kCoord3dAbcy16) return call(Codes<std::uint16_t, 4>{});
  return call(Codes<std::uint16_t, 3>{});
}

// x and y only choose a pixel: float is enough.
struct AxisInPx {
  float scale, offset;  // of the code, to focal length times coordinate in mm
  AxisInPx(const Scan3dAxis& axis, double px_per_unit)
      : scale(static_cast<float>(axis.scale * px_per_unit)),
        offset(static_cast<float>(axis.offset * px_per_unit)) {}
  float times_z(float code) const { return code * scale + offset; }
};

const std::uint8_t* row_of(const PayloadPart& part, int y) {
  return part.bytes.data() +
         static_cast<std::size_t>(y) * (row_bytes(part.format, part.width) + part.x_padding_bytes);
}

template <class C>
void depth_row(const std::uint8_t* points, int width, const AxisInMm& axis, float* depth_mm) {
  for (int x = 0; x < width; ++x)
    depth_mm[x] = axis.depth_mm(C::load(points + x * C::kStrideBytes, 2));
}

// Whether each point of the row that has depth lies on the ray of its own pixel.
template <class C>
bool row_on_rays(const std::uint8_t* points, int width, const Scan3d& s, float dv,
                 const float* depth_mm) {
  const double px_per_unit = s.mm_per_unit * s.focal_length_px;
  const AxisInPx a(s.a, px_per_unit), b(s.b, px_per_unit * s.aspect_ratio);
  const float cu = static_cast<float>(s.principal_u_px);
  int off_rays = 0;
  for (int x = 0; x < width; ++x) {
    const std::uint8_t* point = points + x * C::kStrideBytes;
    const float z = depth_mm[x];
    const float u_times_z = a.times_z(static_cast<float>(C::load(point, 0)));
    const float v_times_z = b.times_z(static_cast<float>(C::load(point, 1)));
    const float error_u = std::abs(u_times_z - (static_cast<float>(x) - cu) * z);
    const float error_v = std::abs(v_times_z - dv * z);
    const float limit = kGridTolerance_px * z;
    // Where there is no depth x and y mean nothing; where they are NaN the point is off its ray.
    const int near = static_cast<int>(error_u <= limit) & static_cast<int>(error_v <= limit);
    off_rays += static_cast<int>(z > 0) & (1 - near);
  }
  return off_rays == 0;
}

template <class C>
bool depth_of(const PayloadPart& part, const Scan3d& s, float* depth_mm) {
  const AxisInMm c(s.c, s.mm_per_unit);
  bool on_rays = true;
  for (int y = 0; y < part.height; ++y) {
    float* row_mm = depth_mm + static_cast<std::ptrdiff_t>(y) * part.width;
    depth_row<C>(row_of(part, y), part.width, c, row_mm);
    const float dv = static_cast<float>(y - s.principal_v_px);
    on_rays = on_rays && row_on_rays<C>(row_of(part, y), part.width, s, dv, row_mm);
  }
  return on_rays;
}

template <class C>
void project(const PayloadPart& part, const Scan3d& s, const float* grid_mm,
             const std::uint8_t* grid_gray, float* depth_mm, std::uint8_t* gray) {
  const double px_per_unit = s.mm_per_unit * s.focal_length_px;
  const AxisInPx a(s.a, px_per_unit), b(s.b, px_per_unit * s.aspect_ratio);
  const float cu = static_cast<float>(s.principal_u_px), cv = static_cast<float>(s.principal_v_px);
  for (int y = 0; y < part.height; ++y) {
    const std::uint8_t* point = row_of(part, y);
    for (int x = 0; x < part.width; ++x, point += C::kStrideBytes) {
      const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(y) * part.width + x;
      const float z = grid_mm[from];
      if (z == 0) continue;
      const float u = std::floor(a.times_z(static_cast<float>(C::load(point, 0))) / z + cu + 0.5f);
      const float v = std::floor(b.times_z(static_cast<float>(C::load(point, 1))) / z + cv + 0.5f);
      // Written so that NaN is outside.
      if (!(u >= 0 && v >= 0 && u < static_cast<float>(part.width) &&
            v < static_cast<float>(part.height)))
        continue;
      const std::ptrdiff_t to =
          static_cast<std::ptrdiff_t>(v) * part.width + static_cast<std::ptrdiff_t>(u);
      if (depth_mm[to] != 0 && depth_mm[to] <= z) continue;
      depth_mm[to] = z;
      if (grid_gray != nullptr) gray[to] = grid_gray[from];
    }
  }
}

}  // namespace

bool grid_depth(const PayloadPart& part, const Scan3d& scan3d, float* depth_mm) {
  return with_codes(part.format,
                    [&](auto codes) { return depth_of<decltype(codes)>(part, scan3d, depth_mm); });
}

void project_grid(const PayloadPart& part, const Scan3d& scan3d, const float* grid_mm,
                  const std::uint8_t* grid_gray, float* depth_mm, std::uint8_t* gray) {
  const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(part.width) * part.height;
  std::fill(depth_mm, depth_mm + count, 0.0f);
  if (grid_gray != nullptr) std::fill(gray, gray + count, std::uint8_t{0});
  with_codes(part.format, [&](auto codes) {
    project<decltype(codes)>(part, scan3d, grid_mm, grid_gray, depth_mm, gray);
  });
}

void grid_gray(const PayloadPart& part, std::uint8_t* gray) {
  for (int y = 0; y < part.height; ++y) {
    const std::uint8_t* row = row_of(part, y);
    for (int x = 0; x < part.width; ++x) *gray++ = row[8 * x + 7];
  }
}

}  // namespace binpick::drivers
