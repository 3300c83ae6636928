// The pixel formats that are understood, by the names and numbers of the GenICam Pixel Format
// Naming Convention (PFNC 2.4). Vendors' own formats have a name in the sensor's XML and a number
// of the vendor's: they are found by name when the sensor is opened.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace binpick::drivers {

enum class PixelFormat {
  kUnknown,
  kMono8,
  kMono10,  // in 16 bits, low bits used
  kMono12,  // in 16 bits, low bits used
  kMono16,
  kMono10p,       // four pixels in 5 bytes, lowest bits first
  kMono12p,       // two pixels in 3 bytes, lowest bits first
  kMono10Packed,  // GigE Vision 1: two pixels in 3 bytes, high bits in the outer bytes
  kMono12Packed,
  kRgb8,
  kBgr8,
  kCoord3dC16,
  kCoord3dC32f,
  kCoord3dAbc16,
  kCoord3dAbcy16,  // a, b, c, intensity
  kCoord3dAbc32f,
  kConfidence8,
  kConfidence16,
};

// kUnknown for any other.
PixelFormat pixel_format_from_number(std::uint32_t number);
PixelFormat pixel_format_from_name(std::string_view name);
const char* pixel_format_name(PixelFormat format);

// Bytes of a row of `width` pixels without padding; 0 where the width does not fill whole bytes.
std::size_t row_bytes(PixelFormat format, int width);

bool is_coord3d(PixelFormat format);
bool is_coord3d_abc(PixelFormat format);  // with x and y
bool is_confidence(PixelFormat format);
bool is_gray_or_colour(PixelFormat format);

}  // namespace binpick::drivers
