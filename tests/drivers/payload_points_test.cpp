// Grids of points (Coord3D_ABC*) against hand-made buffers: as the depth image, or projected.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "drivers/payload_parts.hpp"

namespace binpick::drivers {
namespace {

using testing::ElementsAre;
using U16 = std::vector<std::uint16_t>;
using F32 = std::vector<float>;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// x and y such that the point (u, v) of a 3 x 3 grid lies on its pixel's ray.
F32 points_on_rays(const F32& z, double focal_px) {
  F32 abc;
  for (int i = 0; i < 9; ++i) {
    abc.push_back(static_cast<float>((i % 3 - 1) / focal_px * static_cast<double>(z[i])));
    abc.push_back(static_cast<float>((i / 3 - 1) / focal_px * static_cast<double>(z[i])));
    abc.push_back(z[i]);
  }
  return abc;
}

TEST(PayloadPoints, AbcPointsOnTheirRaysAreTheDepthImage) {
  Conversion c(3, 3);
  const F32 z = {500, 501, 502, 0, 504, kNan, 506, 507, 508};
  const auto bytes = bytes_of(points_on_rays(z, 100));
  ASSERT_EQ(
      c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dAbc32f, 3, 3, bytes)}, millimetres()),
      DropReason::kNone);
  EXPECT_THAT(c.depth(), ElementsAre(500, 501, 502, 0, 504, 0, 506, 507, 508));
}

TEST(PayloadPoints, AbcPointsOffTheirRaysAreProjectedNearestFirst) {
  Conversion c(3, 3);
  F32 abc = points_on_rays(F32(9, 500), 100);
  // Point 0 belongs to pixel 2 and lies in front of it; point 8 is nowhere in the image.
  abc[0] = 4;
  abc[1] = -4;
  abc[2] = 400;
  abc[8 * 3] = 5000;
  const auto bytes = bytes_of(abc);
  const std::vector<std::uint8_t> gray = {10, 11, 12, 13, 14, 15, 16, 17, 18};
  ASSERT_EQ(c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dAbc32f, 3, 3, bytes),
                   part_of(PartRole::kIntensity, PixelFormat::kMono8, 3, 3, gray)},
                  millimetres()),
            DropReason::kNone);
  EXPECT_THAT(c.depth(), ElementsAre(0, 500, 400, 500, 500, 500, 500, 500, 0));
  EXPECT_THAT(c.gray(), ElementsAre(0, 11, 10, 13, 14, 15, 16, 17, 0));
}

TEST(PayloadPoints, LargerOrDeeperIntensityMovesWithItsPoints) {
  PayloadParams params;
  params.sensor_width = params.sensor_height = 6;
  Conversion c(3, 3, params);
  F32 abc = points_on_rays(F32(9, 500), 100);
  // Points 0 and 1 change places; point 8 is nowhere in the image.
  std::swap(abc[0], abc[3]);
  abc[8 * 3] = 5000;
  const auto points = bytes_of(abc);
  const auto depth = part_of(PartRole::kDepth, PixelFormat::kCoord3dAbc32f, 3, 3, points);
  U16 deep;
  std::vector<std::uint8_t> large;
  for (unsigned i = 0; i < 9; ++i) deep.push_back(static_cast<std::uint16_t>((10 + i) << 8));
  // Blocks whose mean is 10 and up, no pixel of which is that.
  for (unsigned i = 0; i < 36; ++i)
    large.push_back(static_cast<std::uint8_t>(10 + i / 12 * 3 + i % 6 / 2 + (i % 2 == 0 ? 5 : -5)));
  const auto deep_bytes = bytes_of(deep);
  const auto expected = ElementsAre(11, 10, 12, 13, 14, 15, 16, 17, 0);
  ASSERT_EQ(c.run({depth, part_of(PartRole::kIntensity, PixelFormat::kMono16, 3, 3, deep_bytes)},
                  millimetres()),
            DropReason::kNone);
  EXPECT_THAT(c.gray(), expected);
  ASSERT_EQ(c.run({depth, part_of(PartRole::kIntensity, PixelFormat::kMono8, 6, 6, large)},
                  millimetres()),
            DropReason::kNone);
  EXPECT_THAT(c.gray(), expected);
}

TEST(PayloadPoints, OfEqualPointsInAPixelTheFirstStays) {
  Conversion c(3, 3);
  F32 abc = points_on_rays(F32(9, 500), 100);
  // In the middle: points 0, 4 and 5, and behind them point 8. Point 2 is nowhere.
  for (const std::size_t i : {0u, 5u, 8u}) abc[3 * i] = abc[3 * i + 1] = 0;
  abc[3 * 8 + 2] = 501;
  abc[3 * 2] = 5000;
  const auto bytes = bytes_of(abc);
  const std::vector<std::uint8_t> gray = {10, 11, 12, 13, 14, 15, 16, 17, 18};
  ASSERT_EQ(c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dAbc32f, 3, 3, bytes),
                   part_of(PartRole::kIntensity, PixelFormat::kMono8, 3, 3, gray)},
                  millimetres()),
            DropReason::kNone);
  EXPECT_THAT(c.depth(), ElementsAre(0, 500, 0, 500, 500, 0, 500, 500, 0));
  EXPECT_THAT(c.gray(), ElementsAre(0, 11, 0, 13, 10, 0, 16, 17, 0));
}

TEST(PayloadPoints, Abcy16PointsTakeTheirIntensityAlong) {
  Conversion c(2, 2);
  Scan3d scan3d = millimetres(100, 0, 0);
  scan3d.a = scan3d.b = {0.25, -16384 * 0.25, std::nullopt};
  scan3d.c = {0.25, 0, 65535.0};
  constexpr std::uint16_t kMid = 16384, kOne = 20;  // 5 mm at 500 mm: one pixel
  // Point 0 belongs to pixel 3 and lies in front of point 3; point 1 has no depth; point 2 stays.
  const auto bytes = bytes_of(U16{kMid + kOne, kMid + kOne, 1900, 0x1100,  //
                                  kMid + kOne, kMid, 65535, 0x2200,        //
                                  kMid, kMid + kOne, 2000, 0x3300,         //
                                  kMid + kOne, kMid + kOne, 2000, 0x4400});
  ASSERT_EQ(c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dAbcy16, 2, 2, bytes)}, scan3d),
            DropReason::kNone);
  EXPECT_THAT(c.depth(), ElementsAre(0, 0, 500, 475));
  EXPECT_THAT(c.gray(), ElementsAre(0, 0, 0x33, 0x11));
}

TEST(PayloadPoints, Abcy16CarriesIntensityAndHasAnOffsetPerAxis) {
  Conversion c(2, 1);
  Scan3d scan3d = millimetres(100, 0, 0);
  scan3d.a = {0.25, -16384 * 0.25, std::nullopt};
  scan3d.b = scan3d.a;
  scan3d.c = {0.25, 0, 65535.0};
  // Pixel 0: x = y = 0, z = 500. Pixel 1: no measurement.
  const auto bytes = bytes_of(U16{16384, 16384, 2000, 0xAB12, 7, 7, 65535, 0x4300});
  ASSERT_EQ(c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dAbcy16, 2, 1, bytes)}, scan3d),
            DropReason::kNone);
  EXPECT_THAT(c.depth(), ElementsAre(500, 0));
  EXPECT_THAT(c.gray(), ElementsAre(0xAB, 0x43));
}

TEST(PayloadPoints, Abc16WithoutIntensity) {
  Conversion c(1, 1);
  const auto bytes = bytes_of(U16{0, 0, 750});
  ASSERT_EQ(c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dAbc16, 1, 1, bytes)},
                  millimetres(100, 0, 0)),
            DropReason::kNone);
  EXPECT_THAT(c.depth(), ElementsAre(750));
  EXPECT_TRUE(c.frame.frame().intensity.empty());
}

}  // namespace
}  // namespace binpick::drivers
