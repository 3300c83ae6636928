#include "genicam/confidence_rows.hpp"

#include <algorithm>
#include <cmath>

namespace binpick::drivers {

ConfidenceRows::ConfidenceRows(const PayloadPart* part, double min) : part_(part) {
  if (part == nullptr) return;
  const double full = part->format == PixelFormat::kConfidence16 ? 65535 : 255;
  least_ = std::max(1, static_cast<int>(std::ceil(min * full)));
}

}  // namespace binpick::drivers
