// The vector kernels: this file is compiled once per vector unit by foreach_target.
// feature_kernels.hpp states what each function does; the scalar code is what it must agree with
// bit for bit.
#include "simd/feature_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/feature_kernels_hwy.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace binpick::simd::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR  // the build's baseline may be this; the specification serves

void GradientRow(const std::uint8_t* row, std::ptrdiff_t stride, int width,
                 std::int32_t threshold_squared, std::uint8_t* bits) {
  feature_kernels_scalar().gradient_row(row, stride, width, threshold_squared, bits);
}

#else

void GradientRow(const std::uint8_t* row, std::ptrdiff_t stride, int width,
                 std::int32_t threshold_squared, std::uint8_t* bits) {
  const hn::ScalableTag<std::int32_t> d32;
  const hn::Rebind<std::uint8_t, decltype(d32)> d8;
  const int lanes = static_cast<int>(hn::Lanes(d32));
  int x = 1;
  for (; x + lanes + 1 <= width; x += lanes) {
    auto load = [&](std::ptrdiff_t offset) {
      return hn::PromoteTo(d32, hn::LoadU(d8, row + x + offset));
    };
    const auto a0 = load(-stride - 1), a1 = load(-stride), a2 = load(-stride + 1);
    const auto b0 = load(-1), b2 = load(1);
    const auto c0 = load(stride - 1), c1 = load(stride), c2 = load(stride + 1);
    auto gx = hn::Sub(hn::Add(hn::Add(a2, c2), hn::Add(b2, b2)),
                      hn::Add(hn::Add(a0, c0), hn::Add(b0, b0)));
    auto gy = hn::Sub(hn::Add(hn::Add(c0, c2), hn::Add(c1, c1)),
                      hn::Add(hn::Add(a0, a2), hn::Add(a1, a1)));
    const auto zero = hn::Zero(d32);
    const auto weak =
        hn::Lt(hn::Add(hn::Mul(gx, gx), hn::Mul(gy, gy)), hn::Set(d32, threshold_squared));
    // Into the upper half plane, as the scalar code does.
    const auto flip = hn::Or(hn::Lt(gy, zero), hn::And(hn::Eq(gy, zero), hn::Lt(gx, zero)));
    gx = hn::IfThenElse(flip, hn::Neg(gx), gx);
    gy = hn::IfThenElse(flip, hn::Neg(gy), gy);
    const auto ax = hn::Abs(gx);
    const auto gy4096 = hn::ShiftLeft<12>(gy);
    auto sector = zero;
    const auto one = hn::Set(d32, 1);
    for (const std::int32_t tangent : {815, 2737, 6130, 20592}) {
      sector = hn::Add(sector,
                       hn::IfThenZeroElse(hn::Lt(gy4096, hn::Mul(ax, hn::Set(d32, tangent))), one));
    }
    const auto bin =
        hn::And(hn::IfThenElse(hn::Lt(gx, zero), hn::Sub(hn::Set(d32, 8), sector), sector),
                hn::Set(d32, 7));
    const auto something = hn::Or(hn::Ne(gx, zero), hn::Ne(gy, zero));
    const auto bit = hn::IfThenZeroElse(weak, hn::IfThenElseZero(something, hn::Shl(one, bin)));
    hn::StoreU(hn::DemoteTo(d8, bit), d8, bits + x);
  }
  if (x + 1 < width)
    feature_kernels_scalar().gradient_row(row + x - 1, stride, width - (x - 1), threshold_squared,
                                          bits + x - 1);
}

#endif  // HWY_SCALAR

}  // namespace binpick::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace binpick::simd {

HWY_EXPORT(GradientRow);

FeatureKernels feature_kernels_vector(std::size_t target_index) {
  return {HWY_DISPATCH_TABLE(GradientRow)[target_index]};
}

}  // namespace binpick::simd
#endif
