// The vector kernels: this file is compiled once per vector unit by foreach_target; what each
// function does is said in point_rows.hpp, and by the scalar code that it must agree with bit for
// bit. So no fused multiply-add, and depth in double.
#include "genicam/point_rows.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "genicam/point_rows_hwy.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <bit>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace binpick::drivers::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR  // the build's baseline may be this; the specification serves

void DepthRow(const PointAxes& axes, const std::uint8_t* points, int width, float* depth_mm) {
  point_depth_row_scalar(axes, points, width, depth_mm);
}
bool OnRays(const PointAxes& axes, const std::uint8_t* points, int width, int y,
            const float* depth_mm) {
  return points_on_rays_scalar(axes, points, 0, width, y, depth_mm);
}
void TargetsRow(const PointAxes& axes, const std::uint8_t* points, int width, int y,
                int image_height, float* depth_mm, std::int32_t* target) {
  point_targets_row_scalar(axes, points, 0, width, y, image_height, depth_mm, target);
}
void GrayRow(const std::uint8_t* points, int width, std::uint8_t* gray) {
  point_gray_row_scalar(points, width, gray);
}

#else

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;

// Loads the codes of Lanes(D) points as floats.
struct Floats3 {
  static constexpr int kPointBytes = 12;
  static void load(D d, const std::uint8_t* points, V& a, V& b, V& c) {
    hn::LoadInterleaved3(d, reinterpret_cast<const float*>(points), a, b, c);
  }
};
struct Shorts3 {
  static constexpr int kPointBytes = 6;
  static void load(D d, const std::uint8_t* points, V& a, V& b, V& c) {
    const hn::Rebind<std::uint16_t, D> d16;
    const hn::Rebind<std::int32_t, D> d32;
    hn::Vec<decltype(d16)> a16, b16, c16;
    hn::LoadInterleaved3(d16, reinterpret_cast<const std::uint16_t*>(points), a16, b16, c16);
    a = hn::ConvertTo(d, hn::PromoteTo(d32, a16));
    b = hn::ConvertTo(d, hn::PromoteTo(d32, b16));
    c = hn::ConvertTo(d, hn::PromoteTo(d32, c16));
  }
};
struct Shorts4 {
  static constexpr int kPointBytes = 8;
  static void load(D d, const std::uint8_t* points, V& a, V& b, V& c) {
    const hn::Rebind<std::uint16_t, D> d16;
    const hn::Rebind<std::int32_t, D> d32;
    hn::Vec<decltype(d16)> a16, b16, c16, y16;
    hn::LoadInterleaved4(d16, reinterpret_cast<const std::uint16_t*>(points), a16, b16, c16, y16);
    a = hn::ConvertTo(d, hn::PromoteTo(d32, a16));
    b = hn::ConvertTo(d, hn::PromoteTo(d32, b16));
    c = hn::ConvertTo(d, hn::PromoteTo(d32, c16));
  }
};

// Half of the lanes: code * scale + offset in double, rounded to float once.
template <class DHalf>
hn::Vec<DHalf> MillimetresHalf(DHalf d, hn::Vec<DHalf> code, const AxisInMm& axis) {
  const hn::Rebind<double, DHalf> d64;
  const auto wide = hn::PromoteTo(d64, code);
  const auto z = hn::Add(hn::Mul(wide, hn::Set(d64, axis.scale)), hn::Set(d64, axis.offset));
  return hn::DemoteTo(d, z);
}

// The formula, before it is said what is a measurement.
struct InDouble {
  static V millimetres(D d, V code, const AxisInMm& axis) {
    const hn::Half<D> half;
    const auto low = MillimetresHalf(half, hn::LowerHalf(half, code), axis);
    const auto high = MillimetresHalf(half, hn::UpperHalf(half, code), axis);
    return hn::Combine(d, high, low);
  }
};
// Where scale is a float and there is no offset: the product of two floats is exact in double, so
// that its one rounding is that of a product in float.
struct InFloat {
  static V millimetres(D d, V code, const AxisInMm& axis) {
    return hn::Mul(code, hn::Set(d, static_cast<float>(axis.scale)));
  }
};

bool IsFloat(double value) {
  return static_cast<double>(static_cast<float>(value)) == value;
}

// The code that is no measurement. A code is a float: it equals no number that is not.
V InvalidCode(D d, const AxisInMm& axis) {
  return hn::Set(d, IsFloat(axis.invalid_code) ? static_cast<float>(axis.invalid_code)
                                               : std::numeric_limits<float>::quiet_NaN());
}

template <class Codes, class Depth>
int DepthRowOf(const PointAxes& axes, const std::uint8_t* points, int width, float* depth_mm) {
  const D d;
  const AxisInMm axis = axes.c;  // a copy: what is stored may not change it
  const V invalid = InvalidCode(d, axis);
  const V zero = hn::Zero(d), max = hn::Set(d, std::numeric_limits<float>::max());
  const int lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    V a, b, c;
    Codes::load(d, points + x * Codes::kPointBytes, a, b, c);
    const V z = Depth::millimetres(d, c, axis);
    const auto measured = hn::And(hn::Gt(z, zero), hn::Le(z, max));
    hn::StoreU(hn::IfThenElseZero(hn::AndNot(hn::Eq(c, invalid), measured), z), d, depth_mm + x);
  }
  return x;
}

V TimesZ(D d, V code, const AxisInPx& axis) {
  return hn::Add(hn::Mul(code, hn::Set(d, axis.scale)), hn::Set(d, axis.offset));
}

template <class Codes>
int OnRaysOf(const PointAxes& axes, const std::uint8_t* points, int width, int y,
             const float* depth_mm, bool& on_rays) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const V dv = hn::Set(d, static_cast<float>(y) - axes.cv);
  const V steps = hn::Iota(d, 0);
  auto off = hn::FirstN(d, 0);  // none
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    V a, b, c;
    Codes::load(d, points + x * Codes::kPointBytes, a, b, c);
    const V z = hn::LoadU(d, depth_mm + x);
    const V column = hn::Add(hn::Set(d, static_cast<float>(x)), steps);  // exact
    const V du = hn::Sub(column, hn::Set(d, axes.cu));
    const V error_u = hn::Abs(hn::Sub(TimesZ(d, a, axes.a), hn::Mul(du, z)));
    const V error_v = hn::Abs(hn::Sub(TimesZ(d, b, axes.b), hn::Mul(dv, z)));
    // The tolerance is one pixel: z itself.
    const auto near = hn::And(hn::Le(error_u, z), hn::Le(error_v, z));
    off = hn::Or(off, hn::AndNot(near, hn::Gt(z, hn::Zero(d))));
  }
  on_rays = hn::AllFalse(d, off);
  return x;
}

// 0 <= value < end, of floats by their bits: those of negative numbers and NaN are above all
// others. (Those of minus zero, too; it is no sum with a corner, which is not minus zero itself,
// and no measurement.)
hn::Mask<D> Inside(V value, V end) {
  const hn::Rebind<std::uint32_t, D> bits;
  return hn::RebindMask(D(), hn::Lt(hn::BitCast(bits, value), hn::BitCast(bits, end)));
}

// 2^23 added to a whole number from 0 to below it makes the number the last bits of the sum.
constexpr float kWholeInLastBits = 8388608.0f;

template <class Codes, class Depth>
int TargetsRowOf(const PointAxes& axes, const std::uint8_t* points, int width, int y,
                 int image_height, float* depth_mm, std::int32_t* target) {
  const D d;
  const hn::Rebind<std::int32_t, D> d32;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const AxisInMm axis = axes.c;  // copies: what is stored may not change them
  const AxisInPx axis_a = axes.a, axis_b = axes.b;
  const V invalid = InvalidCode(d, axis);
  const V one = hn::Set(d, 1.0f), whole = hn::Set(d, kWholeInLastBits);
  const V u_end = hn::Set(d, static_cast<float>(width));
  const V v_end = hn::Set(d, static_cast<float>(image_height));
  const V none = hn::Set(d, kNoPoint);
  const V corner_u = hn::Set(d, axes.cu + 0.5f), corner_v = hn::Set(d, axes.cv + 0.5f);
  const auto columns = hn::Set(d32, width);
  // What the first bits of both sums add to an index, to be taken off at once, modulo 2^32.
  const std::uint32_t first_bits = std::bit_cast<std::uint32_t>(kWholeInLastBits);
  const std::uint32_t surplus_of_both = first_bits * static_cast<std::uint32_t>(width + 1);
  const auto surplus = hn::Set(d32, static_cast<std::int32_t>(surplus_of_both));
  const auto steps = hn::Iota(d32, 0);  // here: a first value that is not constant is slow
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    V a, b, c;
    Codes::load(d, points + x * Codes::kPointBytes, a, b, c);
    const V z = Depth::millimetres(d, c, axis);
    const V per_z = hn::Div(one, z);
    const V u = hn::Add(hn::Mul(TimesZ(d, a, axis_a), per_z), corner_u);
    const V v = hn::Add(hn::Mul(TimesZ(d, b, axis_b), per_z), corner_v);
    // A point of depth 0 is outside by itself: u is NaN or infinite.
    const auto in_image = hn::And(hn::And(Inside(u, u_end), Inside(v, v_end)), Inside(z, none));
    const auto inside = hn::AndNot(hn::Eq(c, invalid), in_image);
    const auto row = hn::BitCast(d32, hn::Add(hn::Floor(v), whole));
    const auto column = hn::BitCast(d32, hn::Add(hn::Floor(u), whole));
    const auto index = hn::Sub(hn::Add(hn::Mul(row, columns), column), surplus);
    const auto own = hn::Add(hn::Set(d32, y * width + x), steps);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(d32, inside), index, own), d32, target + x);
    hn::StoreU(hn::IfThenElse(inside, z, none), d, depth_mm + x);
  }
  return x;
}

// Calls with the way to depth.
template <class Call>
int WithDepth(const AxisInMm& axis, Call&& call) {
  if (axis.offset == 0 && IsFloat(axis.scale)) return call(InFloat{});
  return call(InDouble{});
}

// Calls with the loader of the layout.
template <class Call>
int WithCodes(PointLayout layout, Call&& call) {
  if (layout == PointLayout::kAbc32f) return call(Floats3{});
  if (layout == PointLayout::kAbcy16) return call(Shorts4{});
  return call(Shorts3{});
}

int PointBytes(PointLayout layout) {
  return WithCodes(layout, [](auto codes) { return decltype(codes)::kPointBytes; });
}

// What is left of a row after whole vectors is the specification's.
void DepthRow(const PointAxes& axes, const std::uint8_t* points, int width, float* depth_mm) {
  const int done = WithCodes(axes.layout, [&](auto codes) {
    return WithDepth(axes.c, [&](auto depth) {
      return DepthRowOf<decltype(codes), decltype(depth)>(axes, points, width, depth_mm);
    });
  });
  point_depth_row_scalar(axes, points + done * PointBytes(axes.layout), width - done,
                         depth_mm + done);
}

bool OnRays(const PointAxes& axes, const std::uint8_t* points, int width, int y,
            const float* depth_mm) {
  bool on_rays = true;
  const int done = WithCodes(axes.layout, [&](auto codes) {
    return OnRaysOf<decltype(codes)>(axes, points, width, y, depth_mm, on_rays);
  });
  return on_rays && points_on_rays_scalar(axes, points, done, width, y, depth_mm);
}

void TargetsRow(const PointAxes& axes, const std::uint8_t* points, int width, int y,
                int image_height, float* depth_mm, std::int32_t* target) {
  const int done = WithCodes(axes.layout, [&](auto codes) {
    return WithDepth(axes.c, [&](auto depth) {
      return TargetsRowOf<decltype(codes), decltype(depth)>(axes, points, width, y, image_height,
                                                            depth_mm, target);
    });
  });
  point_targets_row_scalar(axes, points, done, width, y, image_height, depth_mm, target);
}

// A point is one number of 64 bits, and its highest byte the gray.
void GrayRow(const std::uint8_t* points, int width, std::uint8_t* gray) {
  const hn::ScalableTag<std::uint64_t> d64;
  const hn::Rebind<std::uint8_t, decltype(d64)> d8;
  const int lanes = static_cast<int>(hn::Lanes(d64));
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    const auto whole = hn::LoadU(d64, reinterpret_cast<const std::uint64_t*>(points + 8 * x));
    hn::StoreU(hn::TruncateTo(d8, hn::ShiftRight<56>(whole)), d8, gray + x);
  }
  point_gray_row_scalar(points + 8 * x, width - x, gray + x);
}

#endif

}  // namespace binpick::drivers::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace binpick::drivers {

HWY_EXPORT(DepthRow);
HWY_EXPORT(OnRays);
HWY_EXPORT(TargetsRow);
HWY_EXPORT(GrayRow);

void point_depth_row(const PointAxes& axes, const std::uint8_t* points, int width,
                     float* depth_mm) {
  HWY_DYNAMIC_DISPATCH(DepthRow)(axes, points, width, depth_mm);
}

bool points_on_rays(const PointAxes& axes, const std::uint8_t* points, int width, int y,
                    const float* depth_mm) {
  return HWY_DYNAMIC_DISPATCH(OnRays)(axes, points, width, y, depth_mm);
}

void point_targets_row(const PointAxes& axes, const std::uint8_t* points, int width, int y,
                       int image_height, float* depth_mm, std::int32_t* target) {
  HWY_DYNAMIC_DISPATCH(TargetsRow)(axes, points, width, y, image_height, depth_mm, target);
}

void point_gray_row(const std::uint8_t* points, int width, std::uint8_t* gray) {
  HWY_DYNAMIC_DISPATCH(GrayRow)(points, width, gray);
}

}  // namespace binpick::drivers
#endif
