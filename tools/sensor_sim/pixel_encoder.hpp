// How a scene becomes the bytes of one component: a table of pixel formats, each with its encoder.
// Thread-safe: functions of their arguments.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "feature_map.hpp"
#include "scene_source.hpp"

namespace binpick::sim {

// Numbers of the Pixel Format Naming Convention; ABCY16 is LUCID's own.
enum PixelFormatCode : std::uint32_t {
  kMono8 = 0x01080001,
  kMono10 = 0x01100003,
  kMono12 = 0x01100005,
  kMono16 = 0x01100007,
  kRgb8 = 0x02180014,
  kCoord3dC16 = 0x011000b8,
  kCoord3dC32f = 0x012000bf,
  kCoord3dAbc16 = 0x023000b9,
  kCoord3dAbc32f = 0x026000c0,
  kCoord3dAbcy16 = 0x82400403,
  kConfidence8 = 0x010800c6,
  kConfidence16 = 0x011000c7,
};

// What the sensor says in its Scan3d features, per axis A, B, C: coordinate = code x scale +
// offset. Floating-point formats send the coordinate itself.
struct Scan3dValues {
  std::uint32_t output_mode = kProjectedC;
  std::array<double, kCoordinateCount> scale{1, 1, 1};
  std::array<double, kCoordinateCount> offset{0, 0, 0};
  double invalid_value = 0;  // sent where there is no measurement
  double baseline_m = 0;
};

struct PixelEncoder {
  std::uint32_t format;
  const char* name;
  std::uint32_t components;  // bit n: component n may be sent so
  int bytes_per_pixel;
  // `out` has width x height x bytes_per_pixel bytes. Numbers are little-endian.
  void (*encode)(const SceneFrame&, const Scan3dValues&, std::span<std::uint8_t> out);
};

std::span<const PixelEncoder> pixel_encoders();

// nullptr when the component cannot be sent in this format.
const PixelEncoder* find_encoder(std::uint32_t format, Component component);

}  // namespace binpick::sim
