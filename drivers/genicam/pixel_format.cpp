#include "genicam/pixel_format.hpp"

namespace binpick::drivers {
namespace {

struct FormatEntry {
  PixelFormat format;
  const char* name;
  std::uint32_t number;  // 0: a vendor's own, known by name alone
  int bits;              // a pixel, as stored
};

constexpr FormatEntry kFormats[] = {
    {PixelFormat::kUnknown, "unknown", 0, 0},
    {PixelFormat::kMono8, "Mono8", 0x01080001, 8},
    {PixelFormat::kMono10, "Mono10", 0x01100003, 16},
    {PixelFormat::kMono12, "Mono12", 0x01100005, 16},
    {PixelFormat::kMono16, "Mono16", 0x01100007, 16},
    {PixelFormat::kMono10p, "Mono10p", 0x010A0046, 10},
    {PixelFormat::kMono12p, "Mono12p", 0x010C0047, 12},
    {PixelFormat::kMono10Packed, "Mono10Packed", 0x010C0004, 12},
    {PixelFormat::kMono12Packed, "Mono12Packed", 0x010C0006, 12},
    {PixelFormat::kRgb8, "RGB8", 0x02180014, 24},
    {PixelFormat::kBgr8, "BGR8", 0x02180015, 24},
    {PixelFormat::kCoord3dC16, "Coord3D_C16", 0x011000B8, 16},
    {PixelFormat::kCoord3dC32f, "Coord3D_C32f", 0x012000BF, 32},
    {PixelFormat::kCoord3dAbc16, "Coord3D_ABC16", 0x023000B9, 48},
    {PixelFormat::kCoord3dAbcy16, "Coord3D_ABCY16", 0, 64},
    {PixelFormat::kCoord3dAbc32f, "Coord3D_ABC32f", 0x026000C0, 96},
    {PixelFormat::kConfidence8, "Confidence8", 0x010800C6, 8},
    {PixelFormat::kConfidence16, "Confidence16", 0x011000C7, 16},
};

const FormatEntry& entry(PixelFormat format) {
  return kFormats[static_cast<std::size_t>(format)];
}

}  // namespace

PixelFormat pixel_format_from_number(std::uint32_t number) {
  for (const FormatEntry& e : kFormats) {
    if (number != 0 && e.number == number) return e.format;
  }
  return PixelFormat::kUnknown;
}

PixelFormat pixel_format_from_name(std::string_view name) {
  for (const FormatEntry& e : kFormats) {
    if (e.format != PixelFormat::kUnknown && name == e.name) return e.format;
  }
  return PixelFormat::kUnknown;
}

const char* pixel_format_name(PixelFormat format) {
  return entry(format).name;
}

std::size_t row_bytes(PixelFormat format, int width) {
  const std::size_t bits =
      static_cast<std::size_t>(width) * static_cast<std::size_t>(entry(format).bits);
  return bits % 8 == 0 ? bits / 8 : 0;
}

bool is_coord3d(PixelFormat format) {
  return format == PixelFormat::kCoord3dC16 || format == PixelFormat::kCoord3dC32f ||
         is_coord3d_abc(format);
}

bool is_coord3d_abc(PixelFormat format) {
  return format == PixelFormat::kCoord3dAbc16 || format == PixelFormat::kCoord3dAbcy16 ||
         format == PixelFormat::kCoord3dAbc32f;
}

bool is_confidence(PixelFormat format) {
  return format == PixelFormat::kConfidence8 || format == PixelFormat::kConfidence16;
}

bool is_gray_or_colour(PixelFormat format) {
  return format != PixelFormat::kUnknown && !is_coord3d(format) && !is_confidence(format);
}

}  // namespace binpick::drivers
