// The vector kernels of point_keys.hpp: this file is compiled once per vector unit by
// foreach_target. A key in memory is two numbers of 32 bits, order and gray before depth.
#include "genicam/point_keys.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "genicam/point_keys_hwy.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace binpick::drivers::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR  // the build's baseline may be this; the specification serves

TargetSpan Span(const float* depth_mm, const std::int32_t* target, int count) {
  return target_span_scalar(depth_mm, target, count);
}
void Keys(const float* depth_mm, const std::uint8_t* gray, std::uint32_t first_order, int count,
          double* keys) {
  point_keys_scalar(depth_mm, gray, first_order, count, keys);
}
void TakePixels(double* keys, int count, float* depth_mm, std::uint8_t* gray) {
  take_pixels_scalar(keys, count, depth_mm, gray);
}

#else

using D = hn::ScalableTag<float>;
using D32 = hn::Rebind<std::uint32_t, D>;
using D8 = hn::Rebind<std::uint8_t, D>;

// What is left after whole vectors is the specification's, in all three.

TargetSpan Span(const float* depth_mm, const std::int32_t* target, int count) {
  const D d;
  const hn::Rebind<std::int32_t, D> d32;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto none = hn::Set(d, kNoPoint);
  auto first = hn::Set(d32, std::numeric_limits<std::int32_t>::max());
  auto last = hn::Set(d32, -1);
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto is_point = hn::RebindMask(d32, hn::Lt(hn::LoadU(d, depth_mm + i), none));
    const auto to = hn::LoadU(d32, target + i);
    first = hn::IfThenElse(is_point, hn::Min(first, to), first);
    last = hn::IfThenElse(is_point, hn::Max(last, to), last);
  }
  const TargetSpan rest = target_span_scalar(depth_mm + i, target + i, count - i);
  return {std::min(hn::GetLane(hn::MinOfLanes(d32, first)), rest.first),
          std::max(hn::GetLane(hn::MaxOfLanes(d32, last)), rest.last)};
}

void Keys(const float* depth_mm, const std::uint8_t* gray, std::uint32_t first_order, int count,
          double* keys) {
  const D32 d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  auto order = hn::ShiftLeft<8>(hn::Add(hn::Set(d, first_order), hn::Iota(d, 0)));
  const auto step = hn::Set(d, static_cast<std::uint32_t>(lanes) << 8);
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto low = hn::Or(order, hn::PromoteTo(d, hn::LoadU(D8(), gray + i)));
    const auto high = hn::BitCast(d, hn::LoadU(D(), depth_mm + i));
    hn::StoreInterleaved2(low, high, d, reinterpret_cast<std::uint32_t*>(keys + i));
    order = hn::Add(order, step);
  }
  point_keys_scalar(depth_mm + i, gray + i, first_order + static_cast<std::uint32_t>(i), count - i,
                    keys + i);
}

void TakePixels(double* keys, int count, float* depth_mm, std::uint8_t* gray) {
  const D d;
  const D32 d32;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const hn::RepartitionToWide<D32> d64;
  const auto none = hn::Set(d, kNoPoint);
  const auto empty = hn::Set(d64, std::bit_cast<std::uint64_t>(empty_key()));
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    std::uint32_t* halves = reinterpret_cast<std::uint32_t*>(keys + i);
    std::uint64_t* wide = reinterpret_cast<std::uint64_t*>(keys + i);
    hn::Vec<D32> low, high;
    hn::LoadInterleaved2(d32, halves, low, high);
    hn::StoreU(empty, d64, wide);
    hn::StoreU(empty, d64, wide + lanes / 2);
    const auto depth = hn::BitCast(d, high);
    hn::StoreU(hn::IfThenElseZero(hn::Lt(depth, none), depth), d, depth_mm + i);
    hn::StoreU(hn::TruncateTo(D8(), low), D8(), gray + i);
  }
  take_pixels_scalar(keys + i, count - i, depth_mm + i, gray + i);
}

#endif

}  // namespace binpick::drivers::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace binpick::drivers {

HWY_EXPORT(Span);
HWY_EXPORT(Keys);
HWY_EXPORT(TakePixels);

TargetSpan target_span(const float* depth_mm, const std::int32_t* target, int count) {
  return HWY_DYNAMIC_DISPATCH(Span)(depth_mm, target, count);
}

void point_keys(const float* depth_mm, const std::uint8_t* gray, std::uint32_t first_order,
                int count, double* keys) {
  HWY_DYNAMIC_DISPATCH(Keys)(depth_mm, gray, first_order, count, keys);
}

void take_pixels(double* keys, int count, float* depth_mm, std::uint8_t* gray) {
  HWY_DYNAMIC_DISPATCH(TakePixels)(keys, count, depth_mm, gray);
}

}  // namespace binpick::drivers
#endif
