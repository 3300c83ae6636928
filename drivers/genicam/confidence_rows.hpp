// Which measurements are sure enough to be used.
#pragma once

#include "genicam/payload_part.hpp"

namespace binpick::drivers {

class ConfidenceRows {
 public:
  // `part`: the confidence image, borrowed, or null: everything is sure. `min`: share of full
  // confidence; 0: any but none at all.
  ConfidenceRows(const PayloadPart* part, double min);
  // Sets the depth of row y to `unsure_mm` where it is not sure.
  void apply(int y, float* depth_mm, float unsure_mm = 0) const;
  const PayloadPart* part() const { return part_; }

 private:
  const PayloadPart* part_;
  int least_ = 0;
};

}  // namespace binpick::drivers
