#include "genicam/confidence_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace binpick::drivers {

ConfidenceRows::ConfidenceRows(const PayloadPart* part, double min) : part_(part) {
  if (part == nullptr) return;
  const double full = part->format == PixelFormat::kConfidence16 ? 65535 : 255;
  least_ = std::max(1u, static_cast<unsigned>(std::ceil(min * full)));
}

void ConfidenceRows::apply(int y, float* depth_mm, float unsure_mm) const {
  if (part_ == nullptr) return;
  const std::uint8_t* row = part_->row(y);
  const int width = part_->width;
  if (part_->format == PixelFormat::kConfidence16) {
    for (int x = 0; x < width; ++x) {
      std::uint16_t confidence;
      std::memcpy(&confidence, row + 2 * x, sizeof confidence);
      depth_mm[x] = confidence >= least_ ? depth_mm[x] : unsure_mm;
    }
    return;
  }
  for (int x = 0; x < width; ++x) depth_mm[x] = row[x] >= least_ ? depth_mm[x] : unsure_mm;
}

}  // namespace binpick::drivers
