// What each kind of sensor sends, against buffers made by hand.
#include "pixel_encoder.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "chunk_data.hpp"
#include "personality.hpp"

namespace binpick::sim {
namespace {

// 2 x 2 pixels, one of them without a measurement; 1 code is 0.5 mm.
SceneFrame small_frame() {
  SceneFrame frame;
  frame.width = frame.height = 2;
  frame.depth_codes = {1000, 0, 2000, 0x1234};
  frame.gray = {0x10, 0x20, 0x80, 0xff};
  frame.depth_scale = 0.5;
  frame.fx = 100;
  frame.fy = 200;
  frame.cx = 1;
  frame.cy = 1;
  return frame;
}

std::vector<std::uint8_t> encode(PixelFormatCode format, Component component,
                                 const Scan3dValues& values = {}) {
  const SceneFrame frame = small_frame();
  const PixelEncoder* encoder = find_encoder(format, component);
  EXPECT_NE(encoder, nullptr);
  std::vector<std::uint8_t> out(4 * static_cast<std::size_t>(encoder->bytes_per_pixel), 0xee);
  encoder->encode(frame, values, out);
  return out;
}

using Bytes = std::vector<std::uint8_t>;

float float_at(const Bytes& bytes, std::size_t index) {
  return std::bit_cast<float>(get<std::uint32_t>(&bytes[4 * index], ByteOrder::kLittle));
}
int code_at(const Bytes& bytes, std::size_t index) {
  return get<std::uint16_t>(&bytes[2 * index], ByteOrder::kLittle);
}

TEST(PixelEncoder, SendsDepthCodesAsTheyAre) {
  const Bytes expected = {0xe8, 0x03, 0, 0, 0xd0, 0x07, 0x34, 0x12};
  EXPECT_EQ(encode(kCoord3dC16, kRange), expected);
  EXPECT_EQ(encode(kMono16, kRange), expected);
}

TEST(PixelEncoder, SendsDisparityAsCodes) {
  Scan3dValues values;
  values.output_mode = kDisparityC;
  values.scale[kCoordinateC] = 0.0625;
  values.baseline_m = 0.1;
  const Bytes bytes = encode(kCoord3dC16, kRange, values);
  // d = f t / z = 100 px x 100 mm / 500 mm = 20 px = 320 codes.
  EXPECT_EQ(code_at(bytes, 0), 320);
  EXPECT_EQ(code_at(bytes, 1), 0);
  EXPECT_EQ(code_at(bytes, 2), 160);
}

TEST(PixelEncoder, SendsMillimetresAsFloats) {
  Scan3dValues values;
  values.invalid_value = -1;
  const Bytes bytes = encode(kCoord3dC32f, kRange, values);
  EXPECT_EQ(float_at(bytes, 0), 500.0f);
  EXPECT_EQ(float_at(bytes, 1), -1.0f);
  EXPECT_EQ(float_at(bytes, 2), 1000.0f);
  EXPECT_EQ(float_at(bytes, 3), 0x1234 * 0.5f);
}

TEST(PixelEncoder, SendsPointsAsFloats) {
  const Bytes bytes = encode(kCoord3dAbc32f, kRange);
  ASSERT_EQ(bytes.size(), 48u);
  // Pixel (0, 0): one left of and one above the principal point, at 500 mm.
  EXPECT_EQ(float_at(bytes, 0), -5.0f);
  EXPECT_EQ(float_at(bytes, 1), -2.5f);
  EXPECT_EQ(float_at(bytes, 2), 500.0f);
  EXPECT_EQ(float_at(bytes, 5), 0.0f);
  EXPECT_EQ(float_at(bytes, 6), -10.0f);
  EXPECT_EQ(float_at(bytes, 7), 0.0f);
  EXPECT_EQ(float_at(bytes, 8), 1000.0f);
}

Scan3dValues helios_values() {
  Scan3dValues values;
  values.output_mode = kCalibratedAbcGrid;
  values.scale = {0.5, 0.5, 0.5};
  values.offset = {-1000, -1000, 0};
  values.invalid_value = 65535;
  return values;
}

TEST(PixelEncoder, SendsPointsWithIntensityAsCodes) {
  const Bytes bytes = encode(kCoord3dAbcy16, kRange, helios_values());
  ASSERT_EQ(bytes.size(), 32u);
  const int expected[4][4] = {{1990, 1995, 1000, 0x1000},
                              {65535, 65535, 65535, 0x2000},
                              {1980, 2000, 2000, 0x8000},
                              {2000, 2000, 0x1234, 0xff00}};
  for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(code_at(bytes, i), expected[i / 4][i % 4]) << i;
}

TEST(PixelEncoder, SendsPointsAsCodes) {
  const Bytes bytes = encode(kCoord3dAbc16, kRange, helios_values());
  ASSERT_EQ(bytes.size(), 24u);
  EXPECT_EQ(code_at(bytes, 0), 1990);
  EXPECT_EQ(code_at(bytes, 1), 1995);
  EXPECT_EQ(code_at(bytes, 2), 1000);
  EXPECT_EQ(code_at(bytes, 5), 65535);
}

TEST(PixelEncoder, SendsIntensityInEveryDepth) {
  EXPECT_EQ(encode(kMono8, kIntensity), (Bytes{0x10, 0x20, 0x80, 0xff}));
  EXPECT_EQ(encode(kMono10, kIntensity), (Bytes{0x40, 0, 0x80, 0, 0, 2, 0xfc, 3}));
  EXPECT_EQ(encode(kMono12, kIntensity), (Bytes{0, 1, 0, 2, 0, 8, 0xf0, 0x0f}));
  EXPECT_EQ(encode(kMono16, kIntensity), (Bytes{0, 0x10, 0, 0x20, 0, 0x80, 0, 0xff}));
  EXPECT_EQ(encode(kRgb8, kIntensity),
            (Bytes{0x10, 0x10, 0x10, 0x20, 0x20, 0x20, 0x80, 0x80, 0x80, 0xff, 0xff, 0xff}));
}

TEST(PixelEncoder, SendsConfidence) {
  EXPECT_EQ(encode(kConfidence8, kConfidence), (Bytes{255, 0, 255, 255}));
  EXPECT_EQ(encode(kConfidence16, kConfidence), (Bytes{255, 255, 0, 0, 255, 255, 255, 255}));
}

TEST(PixelEncoder, KnowsWhatAComponentCannotBe) {
  EXPECT_EQ(find_encoder(kMono8, kRange), nullptr);
  EXPECT_EQ(find_encoder(kCoord3dC16, kIntensity), nullptr);
  EXPECT_EQ(find_encoder(0, kRange), nullptr);
}

TEST(Personality, HasAnEncoderForEachOfItsComponents) {
  for (const Personality& personality : personalities()) {
    EXPECT_NE(find_encoder(personality.range_format, kRange), nullptr) << personality.name;
    EXPECT_NE(find_encoder(personality.intensity_format, kIntensity), nullptr);
    EXPECT_NE(find_encoder(personality.confidence_format, kConfidence), nullptr);
    EXPECT_EQ(find_personality(personality.name), &personality);
  }
  EXPECT_EQ(find_personality("nothing"), nullptr);
}

TEST(ChunkData, IsTheImagesTagAndThenEachEnabledChunk) {
  ChunkValues values;
  values.frame_id = 7;
  values.component_id = 4;
  bool enabled[kChunkCount] = {};
  enabled[kChunkFrameId] = enabled[kChunkComponentId] = true;
  const Bytes expected = {0, 0, 0, 1, 0, 0, 0, 99,                          // image
                          0, 0, 0, 0, 0, 0, 0, 7,  0, 0, 0, 3, 0, 0, 0, 8,  // frame id
                          0, 0, 0, 4, 0, 0, 0, 4,  0, 0, 0, 4};             // component
  EXPECT_EQ(chunk_bytes(values, 99, enabled, ByteOrder::kBig, ByteOrder::kBig), expected);
  const Bytes little = chunk_bytes(values, 99, enabled, ByteOrder::kLittle, ByteOrder::kLittle);
  EXPECT_EQ(little[0], 1);
  EXPECT_EQ(little[8], 7);
}

}  // namespace
}  // namespace binpick::sim
