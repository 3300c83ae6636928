#include "genicam/gray_rows.hpp"

#include <cstring>

#include "binpick/base/assert.hpp"

namespace binpick::drivers {
namespace {

void shift_row(const std::uint8_t* source, int width, int shift, std::uint8_t* gray) {
  for (int x = 0; x < width; ++x) {
    const unsigned value = source[2 * x] | static_cast<unsigned>(source[2 * x + 1]) << 8;
    // Saturated: bits above the significant ones are a sensor's mistake, not a dark pixel.
    const unsigned high = value >> shift;
    gray[x] = static_cast<std::uint8_t>(high > 255 ? 255 : high);
  }
}

// Two pixels in three bytes, the high eight bits of each in the outer bytes.
void packed_row(const std::uint8_t* source, int width, std::uint8_t* gray) {
  for (int x = 0; x < width; ++x) gray[x] = source[x / 2 * 3 + x % 2 * 2];
}

// Pixels of `bits` bits one after another, lowest bits first.
void dense_row(const std::uint8_t* source, int width, int bits, std::uint8_t* gray) {
  for (int x = 0; x < width; ++x) {
    const int first_bit = x * bits + bits - 8;
    const unsigned two =
        source[first_bit / 8] |
        (first_bit % 8 != 0 ? static_cast<unsigned>(source[first_bit / 8 + 1]) << 8 : 0u);
    gray[x] = static_cast<std::uint8_t>(two >> first_bit % 8);
  }
}

// Rec. 601 in 15 bits.
void colour_row(const std::uint8_t* source, int width, int red, int blue, std::uint8_t* gray) {
  for (int x = 0; x < width; ++x) {
    const std::uint8_t* p = source + 3 * x;
    gray[x] = static_cast<std::uint8_t>(
        (p[red] * 9798u + p[1] * 19235u + p[blue] * 3735u + 16384u) >> 15);
  }
}

}  // namespace

void gray_row(PixelFormat format, const std::uint8_t* source, int width, std::uint8_t* gray) {
  switch (format) {
    case PixelFormat::kMono8:
      std::memcpy(gray, source, static_cast<std::size_t>(width));
      return;
    case PixelFormat::kMono10:
      return shift_row(source, width, 2, gray);
    case PixelFormat::kMono12:
      return shift_row(source, width, 4, gray);
    case PixelFormat::kMono16:
      return shift_row(source, width, 8, gray);
    case PixelFormat::kMono10p:
      return dense_row(source, width, 10, gray);
    case PixelFormat::kMono12p:
      return dense_row(source, width, 12, gray);
    case PixelFormat::kMono10Packed:
    case PixelFormat::kMono12Packed:
      return packed_row(source, width, gray);
    case PixelFormat::kRgb8:
      return colour_row(source, width, 0, 2, gray);
    case PixelFormat::kBgr8:
      return colour_row(source, width, 2, 0, gray);
    default:
      BINPICK_ASSERT(!"a gray or colour format");
  }
}

void reduce_gray(const std::uint8_t* source, int width, int height, int factor,
                 std::uint8_t* reduced) {
  const unsigned area = static_cast<unsigned>(factor * factor);
  for (int y = 0; y < height / factor; ++y) {
    for (int x = 0; x < width / factor; ++x) {
      unsigned sum = area / 2;
      for (int dy = 0; dy < factor; ++dy) {
        const std::uint8_t* row = source + static_cast<std::ptrdiff_t>(y * factor + dy) * width;
        for (int dx = 0; dx < factor; ++dx) sum += row[x * factor + dx];
      }
      *reduced++ = static_cast<std::uint8_t>(sum / area);
    }
  }
}

}  // namespace binpick::drivers
