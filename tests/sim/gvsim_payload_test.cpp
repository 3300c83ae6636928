// Each kind of sensor that gvsim can be, through the real Aravis: components, formats and sizes.
#include <gtest/gtest.h>

#include "aravis_client.hpp"
#include "simulator_process.hpp"
#include "tiny_scene.hpp"

namespace binpick {
namespace {

constexpr std::uint32_t kC16 = 0x011000b8, kC32f = 0x012000bf, kAbc32f = 0x026000c0;
constexpr std::uint32_t kAbcy16 = 0x82400403, kMono8 = 0x01080001, kMono16 = 0x01100007;
constexpr std::uint32_t kConfidence16 = 0x011000c7;
constexpr std::size_t kPixels = TinyScene::kWidth * TinyScene::kHeight;

struct ExpectedPart {
  std::uint32_t component_id, pixel_format;
  std::size_t bytes_per_pixel;
};

struct Kind {
  const char* name;
  std::vector<ExpectedPart> parts;
  const char* output_mode;
  double scale_c;
};

class GvsimPayload : public testing::TestWithParam<Kind> {};

TEST_P(GvsimPayload, ArrivesWhole) {
  const Kind& kind = GetParam();
  TinyScene scene(2);
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM,
                       {"--bind", address, "--scenes", scene.path(), "--payload", kind.name});
  AravisClient client(address);
  client.set("TriggerMode", "On");
  EXPECT_EQ(client.text("Scan3dOutputMode"), kind.output_mode);
  EXPECT_EQ(client.number("Scan3dCoordinateScale"), kind.scale_c);
  client.start();
  client.execute("TriggerSoftware");
  ArvBuffer* buffer = client.pop(20000);
  ASSERT_NE(buffer, nullptr);
  ASSERT_EQ(arv_buffer_get_status(buffer), ARV_BUFFER_STATUS_SUCCESS);
  const std::vector<ReceivedPart> parts = parts_of(buffer);
  ASSERT_GE(parts.size(), kind.parts.size());
  for (std::size_t i = 0; i < kind.parts.size(); ++i) {
    // A single part carries no component id.
    if (kind.parts.size() > 1) {
      EXPECT_EQ(parts[i].component_id, kind.parts[i].component_id);
    }
    EXPECT_EQ(parts[i].pixel_format, kind.parts[i].pixel_format);
    EXPECT_EQ(parts[i].width, TinyScene::kWidth);
    EXPECT_EQ(parts[i].height, TinyScene::kHeight);
    EXPECT_EQ(parts[i].bytes.size(), kPixels * kind.parts[i].bytes_per_pixel);
  }
  client.give_back(buffer);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, GvsimPayload,
    testing::Values(Kind{"c16", {{4, kC16, 2}, {1, kMono8, 1}}, "ProjectedC", 0.1},
                    Kind{"disparity", {{8, kC16, 2}, {1, kMono8, 1}}, "DisparityC", 0.0625},
                    Kind{"abcy16", {{4, kAbcy16, 8}}, "CalibratedABC_Grid", 0.1},
                    Kind{"mono16-c32f", {{4, kC32f, 4}, {1, kMono16, 2}}, "ProjectedC", 1},
                    Kind{"abc32f",
                         {{4, kAbc32f, 12}, {1, kMono16, 2}, {6, kConfidence16, 2}},
                         "CalibratedABC_Grid",
                         1},
                    Kind{"mono16", {{4, kMono16, 2}, {1, kMono16, 2}}, "ProjectedC", 0.1}),
    [](const auto& test) {
      std::string name = test.param.name;
      for (char& c : name) c = c == '-' ? '_' : c;
      return name;
    });

// Disparity with its chunks: depth comes back to within half a code of disparity.
TEST(GvsimPayload, DisparityBecomesDepthAgain) {
  TinyScene scene(1);
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM,
                       {"--bind", address, "--scenes", scene.path(), "--payload", "disparity"});
  AravisClient client(address);
  client.set("TriggerMode", "On");
  client.start();
  client.execute("TriggerSoftware");
  ArvBuffer* buffer = client.pop(20000);
  ASSERT_NE(buffer, nullptr);
  const auto number = [&](const char* name) {
    return arv_chunk_parser_get_float_value(client.chunks(), buffer, name, nullptr);
  };
  const double f = number("ChunkScan3dFocalLength"), t = number("ChunkScan3dBaseline");
  const double scale = number("ChunkScan3dCoordinateScale");
  ASSERT_EQ(f, TinyScene::kFx);
  ASSERT_EQ(t, 0.16);
  const std::vector<std::uint8_t> bytes = parts_of(buffer).at(0).bytes;
  for (int i = 0; i < static_cast<int>(kPixels); ++i) {
    const auto at = 2 * static_cast<std::size_t>(i);
    const int code = bytes[at] | bytes[at + 1] << 8;
    const double z_mm = TinyScene::depth_code(0, i) * TinyScene::kDepthScale;
    if (z_mm == 0) {
      EXPECT_EQ(code, 0);
    } else {
      EXPECT_NEAR(code * scale, f * t * 1000 / z_mm, scale / 2 + 1e-9);
    }
  }
  client.give_back(buffer);
}

}  // namespace
}  // namespace binpick
