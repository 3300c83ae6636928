#include "pixel_encoder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "byte_order.hpp"

namespace binpick::sim {
namespace {

using Bytes = std::span<std::uint8_t>;

// Each pixel in turn: its index, column, row and depth code.
template <class Visit>
void for_each_pixel(const SceneFrame& frame, const Visit& visit) {
  std::size_t i = 0;
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u, ++i) visit(i, u, v, frame.depth_codes[i]);
  }
}

void put_float(std::uint8_t* out, double value) {
  put_le32(out, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

std::uint16_t code_of(double coordinate, double scale, double offset, double code_max) {
  return static_cast<std::uint16_t>(
      std::clamp(std::nearbyint((coordinate - offset) / scale), 0.0, code_max));
}

std::uint8_t gray_at(const SceneFrame& frame, std::size_t i) {
  return frame.gray.empty() ? std::uint8_t{0} : frame.gray[i];
}

// The codes of the file; as disparity d = f t / z where the sensor says so.
void encode_c16(const SceneFrame& frame, const Scan3dValues& values, Bytes out) {
  const auto invalid = static_cast<std::uint16_t>(values.invalid_value);
  const double scale = values.scale[kCoordinateC], offset = values.offset[kCoordinateC];
  const double ft = frame.fx * values.baseline_m * 1000;  // px mm
  for_each_pixel(frame, [&](std::size_t i, int, int, std::uint16_t code) {
    std::uint16_t sent = code;
    if (code == 0) {
      sent = invalid;
    } else if (values.output_mode == kDisparityC) {
      sent = code_of(ft / (code * frame.depth_scale), scale, offset, 65535);
    }
    put_le16(&out[2 * i], sent);
  });
}

void encode_c32f(const SceneFrame& frame, const Scan3dValues& values, Bytes out) {
  for_each_pixel(frame, [&](std::size_t i, int, int, std::uint16_t code) {
    put_float(&out[4 * i], code == 0 ? values.invalid_value : code * frame.depth_scale);
  });
}

void encode_abc32f(const SceneFrame& frame, const Scan3dValues& values, Bytes out) {
  for_each_pixel(frame, [&](std::size_t i, int u, int v, std::uint16_t code) {
    std::uint8_t* pixel = &out[12 * i];
    const double z = code * frame.depth_scale;
    const bool valid = code != 0;
    put_float(pixel, valid ? (u - frame.cx) / frame.fx * z : values.invalid_value);
    put_float(pixel + 4, valid ? (v - frame.cy) / frame.fy * z : values.invalid_value);
    put_float(pixel + 8, valid ? z : values.invalid_value);
  });
}

// A, B, C as codes; the code that means invalid is never used for a measurement.
void put_abc16(std::uint8_t* pixel, const SceneFrame& frame, const Scan3dValues& values, int u,
               int v, std::uint16_t code) {
  const auto invalid = static_cast<std::uint16_t>(values.invalid_value);
  if (code == 0) {
    for (int axis = 0; axis < 3; ++axis) put_le16(pixel + 2 * axis, invalid);
    return;
  }
  const double code_max = invalid == 65535 ? 65534 : 65535;
  const double z = code * frame.depth_scale;
  const double xyz[3] = {(u - frame.cx) / frame.fx * z, (v - frame.cy) / frame.fy * z, z};
  for (std::size_t axis = 0; axis < 3; ++axis)
    put_le16(pixel + 2 * axis,
             code_of(xyz[axis], values.scale[axis], values.offset[axis], code_max));
}

void encode_abc16(const SceneFrame& frame, const Scan3dValues& values, Bytes out) {
  for_each_pixel(frame, [&](std::size_t i, int u, int v, std::uint16_t code) {
    put_abc16(&out[6 * i], frame, values, u, v, code);
  });
}

void encode_abcy16(const SceneFrame& frame, const Scan3dValues& values, Bytes out) {
  for_each_pixel(frame, [&](std::size_t i, int u, int v, std::uint16_t code) {
    put_abc16(&out[8 * i], frame, values, u, v, code);
    put_le16(&out[8 * i + 6], static_cast<std::uint16_t>(gray_at(frame, i) << 8));
  });
}

void encode_mono8(const SceneFrame& frame, const Scan3dValues&, Bytes out) {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = gray_at(frame, i);
}

template <int Bits>
void encode_mono(const SceneFrame& frame, const Scan3dValues&, Bytes out) {
  for (std::size_t i = 0; i < out.size() / 2; ++i)
    put_le16(&out[2 * i], static_cast<std::uint16_t>(gray_at(frame, i) << (Bits - 8)));
}

void encode_rgb8(const SceneFrame& frame, const Scan3dValues&, Bytes out) {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = gray_at(frame, i / 3);
}

void encode_confidence8(const SceneFrame& frame, const Scan3dValues&, Bytes out) {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = frame.depth_codes[i] == 0 ? 0 : 255;
}

void encode_confidence16(const SceneFrame& frame, const Scan3dValues&, Bytes out) {
  for (std::size_t i = 0; i < out.size() / 2; ++i)
    put_le16(&out[2 * i], frame.depth_codes[i] == 0 ? 0 : 65535);
}

constexpr std::uint32_t kAsRange = 1u << kRange;
constexpr std::uint32_t kAsIntensity = 1u << kIntensity;
constexpr std::uint32_t kAsConfidence = 1u << kConfidence;

// Mono16 stands twice: as depth it carries the codes, as intensity the gray values.
constexpr PixelEncoder kEncoders[] = {
    {kCoord3dC16, "Coord3D_C16", kAsRange, 2, encode_c16},
    {kMono16, "Mono16", kAsRange, 2, encode_c16},
    {kCoord3dC32f, "Coord3D_C32f", kAsRange, 4, encode_c32f},
    {kCoord3dAbc16, "Coord3D_ABC16", kAsRange, 6, encode_abc16},
    {kCoord3dAbcy16, "Coord3D_ABCY16", kAsRange, 8, encode_abcy16},
    {kCoord3dAbc32f, "Coord3D_ABC32f", kAsRange, 12, encode_abc32f},
    {kMono8, "Mono8", kAsIntensity, 1, encode_mono8},
    {kMono10, "Mono10", kAsIntensity, 2, encode_mono<10>},
    {kMono12, "Mono12", kAsIntensity, 2, encode_mono<12>},
    {kMono16, "Mono16", kAsIntensity, 2, encode_mono<16>},
    {kRgb8, "RGB8", kAsIntensity, 3, encode_rgb8},
    {kConfidence8, "Confidence8", kAsConfidence, 1, encode_confidence8},
    {kConfidence16, "Confidence16", kAsConfidence, 2, encode_confidence16},
};

}  // namespace

std::span<const PixelEncoder> pixel_encoders() {
  return kEncoders;
}

const PixelEncoder* find_encoder(std::uint32_t format, Component component) {
  for (const PixelEncoder& encoder : kEncoders) {
    if (encoder.format == format && (encoder.components >> component & 1u) != 0) return &encoder;
  }
  return nullptr;
}

}  // namespace binpick::sim
