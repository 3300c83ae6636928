// The vector kernels: this file is compiled once per vector unit by foreach_target.
// feature_kernels.hpp states what each function does; the scalar code is what it must agree with
// bit for bit: the same operations in the same order, division and square root instead of
// estimates, no fused multiply-add.
#include <algorithm>

#include "simd/feature_kernels.hpp"
#include "simd/normal_bit.hpp"
#include "simd/surface_slope.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/feature_kernels_hwy.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace binpick::simd::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR  // the build's baseline may be this; the specification serves

FeatureKernels VectorKernels() {
  return feature_kernels_scalar();
}

#else

// As many pixels at once as a vector has floats.
using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using Bytes = hn::Rebind<std::uint8_t, Ints>;

int PixelsAtOnce() {
  return static_cast<int>(hn::Lanes(Floats()));
}

// Calls body(x) for the first pixel of each vector in [first, last), which has room for one. The
// last vector is moved back to end at `last`: some pixels are done twice.
template <class Body>
HWY_INLINE void ForVectors(int first, int last, const Body& body) {
  const int lanes = PixelsAtOnce();
  for (int x = first; x < last; x += lanes) body(std::min(x, last - lanes));
}

HWY_INLINE hn::Vec<Floats> Number(float value) {
  return hn::Set(Floats(), value);
}

// gradient_bit()
HWY_INLINE hn::Vec<Ints> GradientBit(hn::Vec<Ints> gx, hn::Vec<Ints> gy) {
  const Ints d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1);
  const auto flip = hn::Or(hn::Lt(gy, zero), hn::And(hn::Eq(gy, zero), hn::Lt(gx, zero)));
  gx = hn::IfThenElse(flip, hn::Neg(gx), gx);
  gy = hn::IfThenElse(flip, hn::Neg(gy), gy);
  const auto ax = hn::Abs(gx);
  const auto gy4096 = hn::ShiftLeft<12>(gy);
  auto sector = zero;
  for (const std::int32_t tangent : {815, 2737, 6130, 20592}) {
    sector =
        hn::Add(sector, hn::IfThenZeroElse(hn::Lt(gy4096, hn::Mul(ax, hn::Set(d, tangent))), one));
  }
  const auto bin = hn::And(hn::IfThenElse(hn::Lt(gx, zero), hn::Sub(hn::Set(d, 8), sector), sector),
                           hn::Set(d, 7));
  const auto something = hn::Or(hn::Ne(gx, zero), hn::Ne(gy, zero));
  return hn::IfThenElseZero(something, hn::Shl(one, bin));
}

void GradientRow(const std::uint8_t* row, std::ptrdiff_t stride, int width,
                 std::int32_t threshold_squared, std::uint8_t* bits) {
  if (width - 2 < PixelsAtOnce())
    return feature_kernels_scalar().gradient_row(row, stride, width, threshold_squared, bits);
  ForVectors(1, width - 1, [&](int x) {
    const auto load = [&](std::ptrdiff_t offset) {
      return hn::PromoteTo(Ints(), hn::LoadU(Bytes(), row + x + offset));
    };
    const auto a0 = load(-stride - 1), a1 = load(-stride), a2 = load(-stride + 1);
    const auto b0 = load(-1), b2 = load(1);
    const auto c0 = load(stride - 1), c1 = load(stride), c2 = load(stride + 1);
    const auto gx = hn::Sub(hn::Add(hn::Add(a2, c2), hn::Add(b2, b2)),
                            hn::Add(hn::Add(a0, c0), hn::Add(b0, b0)));
    const auto gy = hn::Sub(hn::Add(hn::Add(c0, c2), hn::Add(c1, c1)),
                            hn::Add(hn::Add(a0, a2), hn::Add(a1, a1)));
    const auto weak =
        hn::Lt(hn::Add(hn::Mul(gx, gx), hn::Mul(gy, gy)), hn::Set(Ints(), threshold_squared));
    const auto bit = hn::IfThenZeroElse(weak, GradientBit(gx, gy));
    hn::StoreU(hn::DemoteTo(Bytes(), bit), Bytes(), bits + x);
  });
}

void StepRow(ImageView<const float> depth_mm, int y, float noise, std::uint8_t* bits) {
  if (depth_mm.width - 2 < PixelsAtOnce())
    return feature_kernels_scalar().step_row(depth_mm, y, noise, bits);
  const auto zero = Number(0), one = Number(1), two = Number(2);
  const auto limit = Number(kDepthEdgeRatio), noise_limit = Number(kStepInNoise * noise);
  ForVectors(1, depth_mm.width - 1, [&](int x) {
    const float* at = depth_mm.row(y) + x;
    const auto z = hn::LoadU(Floats(), at);
    const auto per_step = hn::Div(one, hn::Mul(z, hn::Max(limit, hn::Mul(noise_limit, z))));
    const auto difference = [&](std::ptrdiff_t offset) {
      const auto other = hn::LoadU(Floats(), at + offset);
      const auto steps = hn::Mul(hn::Sub(other, z), per_step);
      return hn::IfThenElse(hn::Gt(other, zero), hn::Min(hn::Max(steps, Number(-2)), two), two);
    };
    const std::ptrdiff_t s = depth_mm.stride;
    const auto a0 = difference(-s - 1), a1 = difference(-s), a2 = difference(-s + 1);
    const auto b0 = difference(-1), b2 = difference(1);
    const auto c0 = difference(s - 1), c1 = difference(s), c2 = difference(s + 1);
    const auto weighted = [&](auto first, auto middle, auto last) {
      return hn::Add(hn::Add(first, hn::Mul(two, middle)), last);
    };
    const auto gx = hn::Sub(weighted(a2, b2, c2), weighted(a0, b0, c0));
    const auto gy = hn::Sub(weighted(c0, c1, c2), weighted(a0, a1, a2));
    const auto bend = hn::Max(hn::Max(hn::Add(b0, b2), hn::Add(a1, c1)),
                              hn::Max(hn::Add(a0, c2), hn::Add(a2, c0)));
    const auto strong = hn::Ge(hn::Add(hn::Mul(gx, gx), hn::Mul(gy, gy)), Number(4));
    const auto edge = hn::And(hn::Gt(z, zero), hn::And(hn::Ge(bend, one), strong));
    const auto whole = [&](auto v) { return hn::ConvertTo(Ints(), hn::Mul(v, Number(1024))); };
    const auto bit =
        hn::IfThenElseZero(hn::RebindMask(Ints(), edge), GradientBit(whole(gx), whole(gy)));
    hn::StoreU(hn::DemoteTo(Bytes(), bit), Bytes(), bits + x);
  });
}

// What fit_ray_normal() sums over the pixels of one surface around a pixel.
struct PlaneSums {
  hn::Vec<Floats> count, a11, a12, a22, b1, b2;
};

HWY_INLINE PlaneSums SumPlane(const float* at, std::ptrdiff_t stride, hn::Vec<Floats> z) {
  const auto limit = hn::Mul(z, Number(kSameSurfaceRatio));
  // Four sums of small integers, of at most 25, 50, 50 and 200, in one.
  constexpr int kA11 = 6, kA22 = 12, kA12 = 18, kA12Offset = 4;
  auto packed = hn::Zero(Ints());
  auto b1 = Number(0), b2 = Number(0);
  for (int dy = -2; dy <= 2; ++dy) {
    const auto difference = [&](int dx) {
      const auto dz = hn::Sub(hn::LoadU(Floats(), at + dy * stride + dx), z);
      const auto same_surface = hn::Le(hn::Abs(dz), limit);
      const std::int32_t add =
          1 + (dx * dx << kA11) + (dy * dy << kA22) + ((dx * dy + kA12Offset) << kA12);
      packed = hn::Add(
          packed, hn::IfThenElseZero(hn::RebindMask(Ints(), same_surface), hn::Set(Ints(), add)));
      return hn::IfThenElseZero(same_surface, dz);
    };
    const auto d0 = difference(-2), d1 = difference(-1), d2 = difference(0), d3 = difference(1),
               d4 = difference(2);
    b1 = hn::Add(b1, hn::Add(hn::Mul(Number(2), hn::Sub(d4, d0)), hn::Sub(d3, d1)));
    const auto along = hn::Add(hn::Add(hn::Add(d0, d1), hn::Add(d3, d4)), d2);
    b2 = hn::Add(b2, hn::Mul(Number(static_cast<float>(dy)), along));
  }
  const auto number = [](auto v) { return hn::ConvertTo(Floats(), v); };
  const auto six_bits = hn::Set(Ints(), 63);
  const auto count = hn::And(packed, six_bits);
  const auto a12 = hn::Sub(hn::ShiftRight<kA12>(packed), hn::ShiftLeft<2>(count));
  static_assert(kA12Offset == 1 << 2);
  return {number(count),
          number(hn::And(hn::ShiftRight<kA11>(packed), six_bits)),
          number(a12),
          number(hn::And(hn::ShiftRight<kA22>(packed), six_bits)),
          b1,
          b2};
}

void FitRow(ImageView<const float> depth_mm, const CameraIntrinsics& camera, int y,
            const NormalRow& to) {
  if (depth_mm.width - 4 < PixelsAtOnce())
    return feature_kernels_scalar().fit_row(depth_mm, camera, y, to);
  const auto one = Number(1);
  const auto fx = Number(static_cast<float>(camera.fx)), fy = Number(static_cast<float>(camera.fy));
  const auto cx = Number(static_cast<float>(camera.cx));
  const auto yr = hn::Div(Number(static_cast<float>(y) - static_cast<float>(camera.cy)), fy);
  ForVectors(2, depth_mm.width - 2, [&](int x) {
    const float* at = depth_mm.row(y) + x;
    const auto z = hn::LoadU(Floats(), at);
    const PlaneSums s = SumPlane(at, depth_mm.stride, z);
    const auto det = hn::Sub(hn::Mul(s.a11, s.a22), hn::Mul(s.a12, s.a12));
    const auto enough = hn::Ge(s.count, Number(static_cast<float>(kPlanePixelsMin)));
    const auto fits =
        hn::And(hn::Gt(z, Number(0)), hn::And(enough, hn::Ge(det, Number(kPlaneDeterminantMin))));
    const auto scale = hn::Div(one, hn::Mul(det, z));
    const auto slope = [&](auto a, auto b, auto c, auto e, auto focal) {
      return hn::Mul(hn::Mul(hn::Sub(hn::Mul(a, b), hn::Mul(c, e)), scale), focal);
    };
    const auto p = slope(s.a22, s.b1, s.a12, s.b2, fx), q = slope(s.a11, s.b2, s.a12, s.b1, fy);
    const auto xr =
        hn::Div(hn::Sub(hn::Add(hn::Iota(Floats(), 0), Number(static_cast<float>(x))), cx), fx);
    const auto nz = hn::Neg(hn::Add(hn::Add(one, hn::Mul(xr, p)), hn::Mul(yr, q)));
    const auto inv_n =
        hn::Div(one, hn::Sqrt(hn::Add(hn::Add(hn::Mul(p, p), hn::Mul(q, q)), hn::Mul(nz, nz))));
    const auto rz = hn::Div(one, hn::Sqrt(hn::Add(hn::Add(one, hn::Mul(xr, xr)), hn::Mul(yr, yr))));
    const auto rx = hn::Mul(xr, rz), ry = hn::Mul(yr, rz), k = hn::Div(one, hn::Add(one, rz));
    const auto rxy = hn::Mul(hn::Mul(rx, ry), k);
    const auto turned = [&](auto r, auto own, auto other) {
      const auto kept = hn::Mul(hn::Sub(one, hn::Mul(hn::Mul(r, r), k)), own);
      const auto sum = hn::Sub(hn::Sub(kept, hn::Mul(rxy, other)), hn::Mul(r, nz));
      return hn::IfThenElseZero(fits, hn::Mul(sum, inv_n));
    };
    hn::StoreU(turned(rx, p, q), Floats(), to.x + x);
    hn::StoreU(turned(ry, q, p), Floats(), to.y + x);
    const auto valid = hn::IfThenElseZero(hn::RebindMask(Ints(), fits), hn::Set(Ints(), 1));
    hn::StoreU(hn::DemoteTo(Bytes(), valid), Bytes(), to.valid + x);
  });
}

void NormalBitsRow(NormalCodebook codebook, const NormalRow& from, int width, std::uint8_t* bits) {
  if (width < PixelsAtOnce())
    return feature_kernels_scalar().normal_bits_row(codebook, from, width, bits);
  const NormalCells& cells = normal_cells(codebook);
  const auto number = [](std::int32_t v) { return hn::Set(Ints(), v); };
  ForVectors(0, width, [&](int x) {
    const auto nx = hn::LoadU(Floats(), from.x + x), ny = hn::LoadU(Floats(), from.y + x);
    auto best = nx;
    auto bit = number(cells.first_ring);
    for (int k = 1; k < cells.ring; ++k) {
      const auto along =
          hn::Add(hn::Mul(nx, Number(cells.cosine[k])), hn::Mul(ny, Number(cells.sine[k])));
      const auto nearer = hn::Gt(along, best);
      best = hn::IfThenElse(nearer, along, best);
      bit = hn::IfThenElse(hn::RebindMask(Ints(), nearer), number(cells.first_ring << k), bit);
    }
    const auto facing =
        hn::Lt(hn::Add(hn::Mul(nx, nx), hn::Mul(ny, ny)), Number(cells.tilt_sin2_min));
    bit = hn::IfThenElse(hn::RebindMask(Ints(), facing), number(cells.facing), bit);
    const auto valid = hn::PromoteTo(Ints(), hn::LoadU(Bytes(), from.valid + x));
    bit = hn::IfThenZeroElse(hn::Eq(valid, hn::Zero(Ints())), bit);
    hn::StoreU(hn::DemoteTo(Bytes(), bit), Bytes(), bits + x);
  });
}

void PoolRow(const NormalRow& from, std::ptrdiff_t stride, int width, const NormalRow& to) {
  if (width < PixelsAtOnce()) return feature_kernels_scalar().pool_row(from, stride, width, to);
  ForVectors(0, width, [&](int x) {
    const hn::Rebind<std::uint16_t, Ints> pairs;
    const hn::Repartition<std::uint8_t, decltype(pairs)> flags;
    const std::uint8_t* valid = from.valid + 2 * x;
    const auto column =
        hn::BitCast(pairs, hn::Add(hn::LoadU(flags, valid), hn::LoadU(flags, valid + stride)));
    const auto sums = hn::Add(hn::And(column, hn::Set(pairs, 0xFF)), hn::ShiftRight<8>(column));
    const auto count = hn::PromoteTo(Ints(), sums);
    const auto some = hn::Gt(count, hn::Set(Ints(), 1));
    const auto share = hn::ConvertTo(Floats(), hn::Max(count, hn::Set(Ints(), 1)));
    const auto mean = [&](const float* upper) {
      hn::Vec<Floats> a, b, c, d;
      hn::LoadInterleaved2(Floats(), upper + 2 * x, a, b);
      hn::LoadInterleaved2(Floats(), upper + stride + 2 * x, c, d);
      const auto sum = hn::Add(hn::Add(hn::Add(a, b), c), d);
      return hn::IfThenElseZero(hn::RebindMask(Floats(), some), hn::Div(sum, share));
    };
    hn::StoreU(mean(from.x), Floats(), to.x + x);
    hn::StoreU(mean(from.y), Floats(), to.y + x);
    const auto flag = hn::IfThenElseZero(some, hn::Set(Ints(), 1));
    hn::StoreU(hn::DemoteTo(Bytes(), flag), Bytes(), to.valid + x);
  });
}

void HalveRow(const float* from_mm, std::ptrdiff_t stride, int width, float* to_mm) {
  if (width < PixelsAtOnce())
    return feature_kernels_scalar().halve_row(from_mm, stride, width, to_mm);
  const auto zero = Number(0), one = Number(1), two = Number(2);
  ForVectors(0, width, [&](int x) {
    hn::Vec<Floats> a, b, c, d;
    hn::LoadInterleaved2(Floats(), from_mm + 2 * x, a, b);
    hn::LoadInterleaved2(Floats(), from_mm + stride + 2 * x, c, d);
    auto nearest = Number(kDepthMax_mm), valid = zero;
    const auto look = [&](auto z) {
      const auto measured = hn::Gt(z, zero);
      nearest = hn::IfThenElse(measured, hn::Min(nearest, z), nearest);
      valid = hn::Add(valid, hn::IfThenElseZero(measured, one));
    };
    look(a), look(b), look(c), look(d);
    const auto limit = hn::Mul(nearest, Number(1 + kSameSurfaceRatio));
    auto near_sum = zero, far_sum = zero, near_count = zero;
    const auto add = [&](auto z) {  // what is not measured is 0, and adds nothing to the near sum
      const auto is_near = hn::Le(z, limit);
      near_sum = hn::Add(near_sum, hn::IfThenElseZero(is_near, z));
      far_sum = hn::Add(far_sum, hn::IfThenZeroElse(is_near, z));
      near_count = hn::Add(near_count, hn::IfThenElseZero(hn::And(is_near, hn::Gt(z, zero)), one));
    };
    add(a), add(b), add(c), add(d);
    const auto far_count = hn::Sub(valid, near_count);
    const auto use_near = hn::Or(hn::Ge(near_count, two), hn::Lt(far_count, two));
    const auto mean = hn::Div(hn::IfThenElse(use_near, near_sum, far_sum),
                              hn::IfThenElse(use_near, near_count, far_count));
    hn::StoreU(hn::IfThenElseZero(hn::Ge(valid, two), mean), Floats(), to_mm + x);
  });
}

Roughness TileRoughness(ImageView<const float> depth_mm, int left, int top, int step) {
  const hn::CappedTag<float, 8> d;  // kNoiseTilePx is a multiple of it
  const hn::RebindToSigned<decltype(d)> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int first = std::max(top, step),
            last = std::min(top + kNoiseTilePx, depth_mm.height - step);
  const std::ptrdiff_t down = step * depth_mm.stride;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1), two = hn::Set(d, 2);
  float totals[kNoiseTilePx];
  auto count = hn::Zero(di);
  for (int x = left; x < left + kNoiseTilePx; x += lanes) {
    const auto column = hn::Add(hn::Iota(d, 0), hn::Set(d, static_cast<float>(x)));
    const auto inside =
        hn::And(hn::Ge(column, hn::Set(d, static_cast<float>(step))),
                hn::Lt(column, hn::Set(d, static_cast<float>(depth_mm.width - step))));
    auto total = zero;
    for (int y = first; y < last; ++y) {
      const float* at = depth_mm.row(y) + x;
      const auto here = hn::LoadU(d, at);
      const auto counts = hn::And(inside, hn::Gt(here, zero));
      const auto limit = hn::Mul(here, hn::Set(d, kSameSurfaceRatio)), twice = hn::Div(two, here);
      const auto add = [&](std::ptrdiff_t offset) {
        const auto before = hn::LoadU(d, at - offset), after = hn::LoadU(d, at + offset);
        const auto near = hn::And(hn::Le(hn::Abs(hn::Sub(before, here)), limit),
                                  hn::Le(hn::Abs(hn::Sub(after, here)), limit));
        const auto mask = hn::And(counts, near);  // which no pixel without depth is
        const auto difference =
            hn::Abs(hn::Add(hn::Sub(hn::Div(one, before), twice), hn::Div(one, after)));
        total = hn::Add(total, hn::IfThenElseZero(mask, difference));
        count = hn::Sub(count, hn::VecFromMask(di, hn::RebindMask(di, mask)));
      };
      add(step), add(down);
    }
    hn::StoreU(total, d, totals + x - left);
  }
  Roughness sum;
  for (const float total : totals) sum.total += total;
  sum.count = hn::GetLane(hn::SumOfLanes(di, count));
  return sum;
}

FeatureKernels VectorKernels() {
  return {GradientRow, StepRow, FitRow, NormalBitsRow, PoolRow, HalveRow, TileRoughness};
}

#endif  // HWY_SCALAR

}  // namespace binpick::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace binpick::simd {

HWY_EXPORT(VectorKernels);

FeatureKernels feature_kernels_vector(std::size_t target_index) {
  return HWY_DISPATCH_TABLE(VectorKernels)[target_index]();
}

}  // namespace binpick::simd
#endif
