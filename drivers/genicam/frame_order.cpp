#include "genicam/frame_order.hpp"

#include <algorithm>

namespace binpick::drivers {

bool FrameOrder::advance(std::uint64_t number, std::uint64_t& missed) {
  missed = 0;
  const bool wide = number > 0xFFFF || last_ > 0xFFFF;
  const std::int64_t step =
      wide ? static_cast<std::int64_t>(number - last_)
           : static_cast<std::int16_t>(static_cast<std::uint16_t>(number - last_));
  if (any_ && step <= 0) return false;
  if (any_) {
    const bool wrapped = !wide && number < last_;
    const std::int64_t between = step - 1 - (wrapped ? 1 : 0);
    missed = static_cast<std::uint64_t>(std::max<std::int64_t>(0, between - dropped_));
  }
  any_ = true;
  last_ = number;
  dropped_ = 0;
  return true;
}

}  // namespace binpick::drivers
