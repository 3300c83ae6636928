// The loop over a row's confidences, compiled once per vector unit by foreach_target.
#include "genicam/confidence_rows.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "genicam/confidence_rows_hwy.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace binpick::drivers::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class Confidence>
void KeepSure(const std::uint8_t* row, int width, int least, float unsure_mm, float* depth_mm) {
  const hn::ScalableTag<float> d;
  const hn::Rebind<std::int32_t, decltype(d)> d32;
  const hn::Rebind<Confidence, decltype(d)> dc;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto* confidence = reinterpret_cast<const Confidence*>(row);
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    const auto value = hn::PromoteTo(d32, hn::LoadU(dc, confidence + x));
    const auto sure = hn::RebindMask(d, hn::Gt(value, hn::Set(d32, least - 1)));
    hn::StoreU(hn::IfThenElse(sure, hn::LoadU(d, depth_mm + x), hn::Set(d, unsure_mm)), d,
               depth_mm + x);
  }
  for (; x < width; ++x) {
    Confidence value;
    hwy::CopyBytes<sizeof value>(row + static_cast<std::size_t>(x) * sizeof value, &value);
    if (value < least) depth_mm[x] = unsure_mm;
  }
}

void KeepSure8(const std::uint8_t* row, int width, int least, float unsure_mm, float* depth_mm) {
  KeepSure<std::uint8_t>(row, width, least, unsure_mm, depth_mm);
}
void KeepSure16(const std::uint8_t* row, int width, int least, float unsure_mm, float* depth_mm) {
  KeepSure<std::uint16_t>(row, width, least, unsure_mm, depth_mm);
}

}  // namespace binpick::drivers::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace binpick::drivers {

HWY_EXPORT(KeepSure8);
HWY_EXPORT(KeepSure16);

void ConfidenceRows::apply(int y, float* depth_mm, float unsure_mm) const {
  if (part_ == nullptr) return;
  const std::uint8_t* row = part_->row(y);
  if (part_->format == PixelFormat::kConfidence16) {
    HWY_DYNAMIC_DISPATCH(KeepSure16)(row, part_->width, least_, unsure_mm, depth_mm);
  } else {
    HWY_DYNAMIC_DISPATCH(KeepSure8)(row, part_->width, least_, unsure_mm, depth_mm);
  }
}

}  // namespace binpick::drivers
#endif
