#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "binpick/drivers/bop_dataset.hpp"
#include "drivers/payload_parts.hpp"
#include "genicam/chunk_chain.hpp"
#include "genicam/gray_rows.hpp"
#include "genicam/hole_marks.hpp"
#include "replay/image_file.hpp"

namespace binpick::drivers {
namespace {

using testing::ElementsAre;
using testing::FloatEq;
using U16 = std::vector<std::uint16_t>;
using F32 = std::vector<float>;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(PixelFormat, IsKnownByPfncNumberAndByName) {
  EXPECT_EQ(pixel_format_from_number(0x011000B8), PixelFormat::kCoord3dC16);
  EXPECT_EQ(pixel_format_from_number(0x026000C0), PixelFormat::kCoord3dAbc32f);
  EXPECT_EQ(pixel_format_from_number(0), PixelFormat::kUnknown);
  EXPECT_EQ(pixel_format_from_number(0x01080009), PixelFormat::kUnknown);  // BayerRG8
  EXPECT_EQ(pixel_format_from_name("Coord3D_ABCY16"), PixelFormat::kCoord3dAbcy16);
  EXPECT_EQ(pixel_format_from_name("unknown"), PixelFormat::kUnknown);
  for (int i = 1; i <= static_cast<int>(PixelFormat::kConfidence16); ++i) {
    const auto format = static_cast<PixelFormat>(i);
    EXPECT_EQ(pixel_format_from_name(pixel_format_name(format)), format);
  }
  EXPECT_EQ(row_bytes(PixelFormat::kMono12p, 4), 6u);
  EXPECT_EQ(row_bytes(PixelFormat::kMono10p, 3), 0u);  // no whole bytes
}

TEST(Payload, C16IsCodeTimesScalePlusOffset) {
  Conversion c(3, 2);
  Scan3d scan3d = millimetres();
  scan3d.c = {0.5, 100, 65535.0};
  const auto bytes = bytes_of(U16{0, 1, 2, 1000, 65534, 65535});
  ASSERT_EQ(c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dC16, 3, 2, bytes)}, scan3d),
            DropReason::kNone);
  EXPECT_THAT(c.depth(), ElementsAre(100, 100.5f, 101, 600, 32867, 0));
  EXPECT_TRUE(c.frame.frame().intensity.empty());
  EXPECT_EQ(c.frame.frame().camera.fx, 100);
  EXPECT_EQ(c.frame.frame().camera.width, 3);
}

TEST(Payload, NegativeDepthAndOtherUnitsOfLength) {
  Conversion c(2, 1);
  Scan3d scan3d = millimetres();
  scan3d.c = {0.001, -0.5, std::nullopt};
  scan3d.mm_per_unit = 1000;  // a sensor that speaks of metres
  const auto bytes = bytes_of(U16{400, 1500});
  ASSERT_EQ(c.run({part_of(PartRole::kDepth, PixelFormat::kMono16, 2, 1, bytes)}, scan3d),
            DropReason::kNone);
  EXPECT_THAT(c.depth(), ElementsAre(0, FloatEq(1000)));
}

TEST(Payload, FramesSayWhetherTheirDepthsAreCodes) {
  Conversion c(2, 1);
  const auto scale_of = [&](PixelFormat format, const Scan3d& scan3d,
                            const std::vector<std::uint8_t>& bytes) {
    EXPECT_EQ(c.run({part_of(PartRole::kDepth, format, 2, 1, bytes)}, scan3d), DropReason::kNone);
    return c.frame.frame().depth_scale_mm;
  };
  const auto codes = bytes_of(U16{0, 4000});
  Scan3d scan3d = millimetres();
  scan3d.c.scale = 0.25;
  EXPECT_EQ(scale_of(PixelFormat::kCoord3dC16, scan3d, codes), 0.25);
  scan3d.mm_per_unit = 10;
  EXPECT_EQ(scale_of(PixelFormat::kMono16, scan3d, codes), 2.5);
  EXPECT_EQ(scale_of(PixelFormat::kCoord3dC32f, scan3d, bytes_of(F32{1, 2})), 0);
  scan3d.c.offset = 1;
  EXPECT_EQ(scale_of(PixelFormat::kCoord3dC16, scan3d, codes), 0);
  scan3d.c.offset = 0;
  scan3d.kind = DepthKind::kDisparity;
  scan3d.baseline_mm = 65;
  scan3d.focal_length_px = 1000;
  EXPECT_EQ(scale_of(PixelFormat::kCoord3dC16, scan3d, codes), 0);
}

TEST(Payload, DisparityIsFocalLengthTimesBaselineOverDisparity) {
  Conversion c(4, 1);
  Scan3d scan3d = millimetres(1000);
  scan3d.kind = DepthKind::kDisparity;
  scan3d.baseline_mm = 65;
  scan3d.c = {1.0 / 16, 0, 0.0};
  const auto bytes = bytes_of(U16{0, 16, 160, 1600});
  ASSERT_EQ(c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dC16, 4, 1, bytes)}, scan3d),
            DropReason::kNone);
  EXPECT_THAT(c.depth(), ElementsAre(0, 65000, 6500, 650));
  // The next frame's chunks say otherwise.
  scan3d.baseline_mm = 130;
  c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dC16, 4, 1, bytes)}, scan3d);
  EXPECT_THAT(c.depth(), ElementsAre(0, 130000, 13000, 1300));
}

TEST(Payload, C32fDropsWhatIsNoNumber) {
  Conversion c(6, 1);
  const auto bytes = bytes_of(F32{500.25f, kNan, kInfinity, -3, -1, 0});
  Scan3d scan3d = millimetres();
  scan3d.c.invalid_code = -1;
  ASSERT_EQ(c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dC32f, 6, 1, bytes)}, scan3d),
            DropReason::kNone);
  EXPECT_THAT(c.depth(), ElementsAre(500.25f, 0, 0, 0, 0, 0));
}

TEST(Payload, ConfidenceDecidesWhatIsMeasured) {
  const auto depth = bytes_of(U16{500, 501, 502});
  const auto part = part_of(PartRole::kDepth, PixelFormat::kCoord3dC16, 3, 1, depth);
  const auto wide = bytes_of(U16{0, 1, 65535});
  const std::vector<std::uint8_t> narrow = {0, 127, 128};
  Conversion any(3, 1);
  any.run({part, part_of(PartRole::kConfidence, PixelFormat::kConfidence16, 3, 1, wide)},
          millimetres());
  EXPECT_THAT(any.depth(), ElementsAre(0, 501, 502));
  PayloadParams params;
  params.confidence_min = 0.5;
  Conversion half(3, 1, params);
  half.run({part, part_of(PartRole::kConfidence, PixelFormat::kConfidence8, 3, 1, narrow)},
           millimetres());
  EXPECT_THAT(half.depth(), ElementsAre(0, 0, 502));
}

TEST(Payload, RowPaddingIsSkipped) {
  Conversion c(2, 2);
  const auto depth = bytes_of(U16{1, 2, 9, 3, 4});  // the last row needs no padding
  auto part = part_of(PartRole::kDepth, PixelFormat::kCoord3dC16, 2, 2, depth);
  part.x_padding_bytes = 2;
  ASSERT_EQ(c.run({part}, millimetres()), DropReason::kNone);
  EXPECT_THAT(c.depth(), ElementsAre(1, 2, 3, 4));
}

// Four pixels with the 8 highest bits 0xFF, 0x80, 0x01, 0x00 and noise below.
TEST(GrayRows, TheHighestEightBitsStay) {
  const auto gray_of = [](PixelFormat format, const std::vector<std::uint8_t>& bytes) {
    EXPECT_EQ(bytes.size(), row_bytes(format, 4));
    std::vector<std::uint8_t> gray(4);
    gray_row(format, bytes.data(), 4, gray.data());
    return std::vector<int>(gray.begin(), gray.end());
  };
  const auto expected = ElementsAre(0xFF, 0x80, 0x01, 0x00);
  EXPECT_THAT(gray_of(PixelFormat::kMono8, {0xFF, 0x80, 0x01, 0x00}), expected);
  EXPECT_THAT(gray_of(PixelFormat::kMono16, bytes_of(U16{0xFF12, 0x80FF, 0x0100, 0x00FF})),
              expected);
  EXPECT_THAT(gray_of(PixelFormat::kMono12, bytes_of(U16{0xFF1, 0x80F, 0x010, 0x00F})), expected);
  EXPECT_THAT(gray_of(PixelFormat::kMono10, bytes_of(U16{0x3FD, 0x203, 0x004, 0x003})), expected);
  EXPECT_THAT(gray_of(PixelFormat::kMono12Packed, {0xFF, 0xF1, 0x80, 0x01, 0x0F, 0x00}), expected);
  EXPECT_THAT(gray_of(PixelFormat::kMono10Packed, {0xFF, 0x31, 0x80, 0x01, 0x03, 0x00}), expected);
  // 0xFF1 then 0x80F: F1 FF|F0.. lowest bits first.
  EXPECT_THAT(gray_of(PixelFormat::kMono12p, {0xF1, 0xFF, 0x80, 0x10, 0xF0, 0x00}), expected);
  // 0x3FD, 0x203, 0x004, 0x003 as 40 bits from the lowest.
  const std::uint64_t bits = 0x3FDull | 0x203ull << 10 | 0x004ull << 20 | 0x003ull << 30;
  std::vector<std::uint8_t> dense(5);
  for (int i = 0; i < 5; ++i) dense[i] = static_cast<std::uint8_t>(bits >> 8 * i);
  EXPECT_THAT(gray_of(PixelFormat::kMono10p, dense), expected);
}

TEST(GrayRows, ColourHasTheBitsThatImageFilesGet) {
  cv::Mat rgb(1, 256 * 64, CV_8UC3);
  std::uint32_t state = 1;
  for (int i = 0; i < 3 * rgb.cols; ++i) {
    state = state * 1664525u + 1013904223u;
    rgb.data[i] = static_cast<std::uint8_t>(state >> 24);
  }
  cv::Mat expected;
  std::vector<std::uint8_t> gray(static_cast<std::size_t>(rgb.cols));
  cv::cvtColor(rgb, expected, cv::COLOR_RGB2GRAY);
  gray_row(PixelFormat::kRgb8, rgb.data, rgb.cols, gray.data());
  EXPECT_TRUE(std::equal(gray.begin(), gray.end(), expected.data));
  cv::cvtColor(rgb, expected, cv::COLOR_BGR2GRAY);
  gray_row(PixelFormat::kBgr8, rgb.data, rgb.cols, gray.data());
  EXPECT_TRUE(std::equal(gray.begin(), gray.end(), expected.data));
}

TEST(Payload, IntensityOfTwiceTheSizeIsAveraged) {
  PayloadParams params;
  params.sensor_width = 4;
  params.sensor_height = 2;
  Conversion c(2, 1, params);
  const auto depth = bytes_of(U16{1, 2});
  const std::vector<std::uint8_t> gray = {10, 20, 0, 0, 30, 40, 0, 1};
  ASSERT_EQ(c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dC16, 2, 1, depth),
                   part_of(PartRole::kIntensity, PixelFormat::kMono8, 4, 2, gray)},
                  millimetres()),
            DropReason::kNone);
  EXPECT_THAT(c.gray(), ElementsAre(25, 0));
}

TEST(Payload, WhatDoesNotFitIsDroppedWithItsReason) {
  PayloadParams params;
  params.sensor_width = 4;
  params.sensor_height = 2;
  Conversion c(4, 2, params);
  const auto bytes = bytes_of(U16(8, 500));
  const auto depth = part_of(PartRole::kDepth, PixelFormat::kCoord3dC16, 4, 2, bytes);
  const auto with = [&](auto change) {
    PayloadPart part = depth;
    change(part);
    return c.run({part}, millimetres());
  };
  EXPECT_EQ(c.run({depth}, millimetres()), DropReason::kNone);
  EXPECT_EQ(c.run({}, millimetres()), DropReason::kNoDepth);
  EXPECT_EQ(with([](auto& p) { p.role = PartRole::kIntensity; }), DropReason::kNoDepth);
  EXPECT_EQ(with([](auto& p) { p.format = PixelFormat::kMono8; }), DropReason::kFormat);
  EXPECT_EQ(with([](auto& p) { p.bytes = p.bytes.first(15); }), DropReason::kPartBounds);
  EXPECT_EQ(with([](auto& p) { p.x_padding_bytes = 1; }), DropReason::kPartBounds);
  EXPECT_EQ(with([](auto& p) { p.width = 8, p.height = 1; }), DropReason::kSize);  // same area
  EXPECT_EQ(with([](auto& p) { p.height = 0; }), DropReason::kSize);
  EXPECT_EQ(with([](auto& p) { p.width = -4, p.height = -2; }), DropReason::kSize);
  EXPECT_EQ(with([](auto& p) { p.width = p.height = 1 << 30; }), DropReason::kSize);
  const auto confidence = bytes_of(U16(2, 1));
  EXPECT_EQ(
      c.run({depth, part_of(PartRole::kConfidence, PixelFormat::kConfidence16, 2, 1, confidence)},
            millimetres()),
      DropReason::kSize);
  EXPECT_EQ(c.run({depth, part_of(PartRole::kIntensity, PixelFormat::kConfidence16, 4, 2, bytes)},
                  millimetres()),
            DropReason::kFormat);
  PayloadParams any;  // no size is set: the pool's limits alone
  Conversion small(3, 2, any);
  EXPECT_EQ(small.run({depth}, millimetres()), DropReason::kSize);
}

TEST(Scan3d, UnusableValuesAreNamed) {
  const auto fault = [](auto change) {
    Scan3d scan3d = millimetres();
    change(scan3d);
    EXPECT_EQ(scan3d_usable(scan3d), scan3d_fault(scan3d).empty());
    return scan3d_fault(scan3d);
  };
  EXPECT_EQ(fault([](Scan3d&) {}), "");
  EXPECT_EQ(fault([](Scan3d& s) { s.c.scale = 0; }), "Scan3dCoordinateScale of axis C is 0");
  EXPECT_EQ(fault([](Scan3d& s) { s.a.scale = std::nan(""); }),
            "Scan3dCoordinateScale of axis A is nan");
  EXPECT_EQ(fault([](Scan3d& s) { s.b.offset = INFINITY; }),
            "Scan3dCoordinateOffset of axis B is inf");
  EXPECT_EQ(fault([](Scan3d& s) { s.focal_length_px = -5; }), "Scan3dFocalLength is -5");
  EXPECT_EQ(fault([](Scan3d& s) { s.principal_v_px = std::nan(""); }),
            "Scan3dPrincipalPointV is nan");
  EXPECT_EQ(fault([](Scan3d& s) { s.aspect_ratio = 0; }), "Scan3dAspectRatio is 0");
  EXPECT_EQ(fault([](Scan3d& s) { s.mm_per_unit = 0; }), "Scan3dDistanceUnit in mm is 0");
  EXPECT_EQ(fault([](Scan3d& s) { s.kind = DepthKind::kDisparity; }), "Scan3dBaseline in mm is 0");
}

TEST(HoleMarks, AnyPacketThatNeverCameIsNoticed) {
  const HoleMarks marks(7);
  std::vector<std::uint8_t> buffer(20000, 1);
  marks.mark(buffer);
  EXPECT_TRUE(marks.any_left(buffer));
  EXPECT_FALSE(marks.any_written_over(buffer));
  const std::vector<std::uint8_t> whole(buffer.size(), 9);
  constexpr std::size_t kPacket = 500;
  for (std::size_t hole = 0; hole + kPacket <= buffer.size(); hole += 37) {
    marks.mark(buffer);
    std::copy(whole.begin(), whole.begin() + hole, buffer.begin());
    std::copy(whole.begin() + hole + kPacket, whole.end(), buffer.begin() + hole + kPacket);
    EXPECT_TRUE(marks.any_left(buffer)) << hole;
    EXPECT_TRUE(marks.any_written_over(buffer)) << hole;
  }
  EXPECT_FALSE(marks.any_left(whole));
}

TEST(ChunkChain, FillsThePayloadOrItWasCut) {
  // Four bytes of image, then six of a value, each with its id and length.
  const std::vector<std::uint8_t> big = {1, 2, 3, 4, 0, 0, 0, 1, 0, 0, 0, 4, 1,
                                         2, 3, 4, 5, 6, 0, 0, 0, 2, 0, 0, 0, 6};
  EXPECT_TRUE(chunks_fill(big, ByteOrder::kBig));
  EXPECT_FALSE(chunks_fill(big, ByteOrder::kLittle));
  EXPECT_FALSE(chunks_fill({}, ByteOrder::kBig));
  EXPECT_FALSE(chunks_fill(std::span(big).subspan(1), ByteOrder::kBig));
  EXPECT_FALSE(chunks_fill(std::span(big).first(big.size() - 1), ByteOrder::kBig));
  const std::vector<std::uint8_t> little = {7, 1, 0, 0, 0, 1, 0, 0, 0};
  EXPECT_TRUE(chunks_fill(little, ByteOrder::kLittle));
  const std::vector<std::uint8_t> huge(64, 0xFF);
  EXPECT_FALSE(chunks_fill(huge, ByteOrder::kBig));
}

TEST(Payload, DepthFromTheWireHasTheBitsOfItsFile) {
  const BopDataset data(BINPICK_TEST_DATA "/bin-sample", "test");
  const BopScene scene = data.scene(1);
  const LoadedFrame loaded = data.load_frame(scene, 0);
  const RawDepth codes = read_depth_image(scene.path + "/depth/000000.png");
  const U16 raw(codes.codes.begin(), codes.codes.end());
  Conversion c(codes.width, codes.height);
  Scan3d scan3d = millimetres();
  scan3d.c = {scene.frames.at(0).depth_scale.value(), 0, 0.0};
  const auto bytes = bytes_of(raw);
  ASSERT_EQ(
      c.run({part_of(PartRole::kDepth, PixelFormat::kCoord3dC16, codes.width, codes.height, bytes)},
            scan3d),
      DropReason::kNone);
  const std::vector<float> depth = c.depth();
  EXPECT_EQ(std::memcmp(depth.data(), loaded.depth_mm.data(), depth.size() * sizeof(float)), 0);
}

}  // namespace
}  // namespace binpick::drivers
