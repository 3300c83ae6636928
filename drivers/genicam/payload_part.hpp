// One image of a frame, as it came from the wire.
#pragma once

#include <cstdint>
#include <span>

#include "genicam/pixel_format.hpp"

namespace binpick::drivers {

enum class PartRole { kDepth, kIntensity, kConfidence, kOther };

// Borrows its bytes.
struct PayloadPart {
  PartRole role = PartRole::kOther;
  PixelFormat format = PixelFormat::kUnknown;
  int width = 0, height = 0;
  std::size_t x_padding_bytes = 0;  // after each row
  std::span<const std::uint8_t> bytes;

  std::size_t stride_bytes() const { return row_bytes(format, width) + x_padding_bytes; }
  const std::uint8_t* row(int y) const {
    return bytes.data() + static_cast<std::size_t>(y) * stride_bytes();
  }
};

}  // namespace binpick::drivers
