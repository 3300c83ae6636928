// gvsim and the real Aravis: what arrives is what the files hold.
#include <gtest/gtest.h>

#include "aravis_client.hpp"
#include "sample_bytes.hpp"
#include "simulator_process.hpp"

namespace binpick {
namespace {

constexpr std::uint32_t kCoord3dC16 = 0x011000b8, kMono8 = 0x01080001;
constexpr int kWidth = 1280, kHeight = 1024;

std::string serial_of(const std::string& address) {
  return address.substr(4);
}

std::vector<std::string> arguments(const std::string& address,
                                   const std::vector<std::string>& more = {}) {
  std::vector<std::string> all = {"--bind",   address,    "--serial", serial_of(address),
                                  "--scenes", kSampleBin, "--scene",  "1",
                                  "--fps",    "20"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

// Both parts of block `id` are those of its image.
void expect_exact(ArvBuffer* buffer) {
  ASSERT_EQ(arv_buffer_get_status(buffer), ARV_BUFFER_STATUS_SUCCESS);
  const auto image = static_cast<int>((arv_buffer_get_frame_id(buffer) - 1) % 2);
  const std::vector<ReceivedPart> parts = parts_of(buffer);
  ASSERT_GE(parts.size(), 2u);
  EXPECT_EQ(parts[0].pixel_format, kCoord3dC16);
  EXPECT_EQ(parts[0].component_id, 4u);
  EXPECT_EQ(parts[1].pixel_format, kMono8);
  EXPECT_EQ(parts[1].component_id, 1u);
  EXPECT_EQ(parts[0].width, kWidth);
  EXPECT_EQ(parts[1].height, kHeight);
  // Not EXPECT_EQ: a difference would print megabytes.
  EXPECT_TRUE(parts[0].bytes == image_bytes(1, "depth", image)) << "depth of image " << image;
  EXPECT_TRUE(parts[1].bytes == image_bytes(1, "gray", image)) << "gray of image " << image;
}

// `count` frames, each on a trigger of its own: whatever else the machine does, none is lost.
void expect_triggered_frames(AravisClient& client, int count) {
  std::uint64_t last = 0;
  for (int i = 0; i < count; ++i) {
    client.execute("TriggerSoftware");
    ArvBuffer* buffer = client.pop(20000);
    ASSERT_NE(buffer, nullptr) << "frame " << i;
    if (last != 0) {
      EXPECT_EQ(arv_buffer_get_frame_id(buffer), last + 1);
    }
    last = arv_buffer_get_frame_id(buffer);
    expect_exact(buffer);
    client.give_back(buffer);
  }
}

void use_software_trigger(AravisClient& client) {
  client.set("TriggerMode", "On");
  client.set("TriggerSource", "Software");
}

class GvsimStream : public testing::TestWithParam<int> {};

TEST_P(GvsimStream, SendsTheFilesBytesAtPacketSize) {
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM, arguments(address));
  AravisClient client(address);
  arv_camera_gv_set_packet_size(client.camera(), GetParam(), nullptr);
  use_software_trigger(client);
  client.start();
  EXPECT_EQ(client.integer("GevSCPSPacketSize"), GetParam());
  expect_triggered_frames(client, 20);
}

TEST_P(GvsimStream, HasLostPacketsRepairedByResend) {
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM, arguments(address));
  AravisClient client(address);
  arv_camera_gv_set_packet_size(client.camera(), GetParam(), nullptr);
  use_software_trigger(client);
  for (const char* loss : {"0.002", "0.05"}) {
    ASSERT_EQ(sim.tell(std::string("fault loss ") + loss), "ok");
    const long long lost = sim.counter("lost");
    client.start();
    expect_triggered_frames(client, 20);
    client.stop();
    EXPECT_GT(sim.counter("lost"), lost);
  }
  EXPECT_GE(sim.counter("resent"), sim.counter("lost"));
}

INSTANTIATE_TEST_SUITE_P(PacketSize, GvsimStream, testing::Values(1400, 9000));

TEST(Gvsim, LetsThePacketSizeBeNegotiated) {
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM, arguments(address));
  AravisClient client(address);
  GError* error = nullptr;
  const guint size = arv_camera_gv_auto_packet_size(client.camera(), &error);
  EXPECT_GE(size, 8900u);  // Aravis halves the interval until it is as small as the increment
  EXPECT_LE(size, 9000u);
  EXPECT_EQ(error, nullptr);
  use_software_trigger(client);
  client.start();
  expect_triggered_frames(client, 3);
}

TEST(Gvsim, AnswersASoftwareTriggerWithOneFrame) {
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM, arguments(address));
  AravisClient client(address);
  use_software_trigger(client);
  client.start();
  EXPECT_EQ(client.pop(300), nullptr);
  expect_triggered_frames(client, 5);
  EXPECT_EQ(client.pop(300), nullptr);
  EXPECT_EQ(client.integer("TriggersMissed"), 0);
  // A line is another source: nothing comes of it until it is chosen.
  EXPECT_EQ(sim.tell("trigger Line0"), "ok");
  EXPECT_EQ(client.pop(300), nullptr);
  client.set("TriggerSource", "Line0");
  EXPECT_EQ(sim.tell("trigger Line0"), "ok");
  ArvBuffer* buffer = client.pop(20000);
  ASSERT_NE(buffer, nullptr);
  EXPECT_EQ(arv_buffer_get_frame_id(buffer), 6u);
  client.give_back(buffer);
}

TEST(Gvsim, RunsFreelyAtItsFrameRate) {
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM, arguments(address));
  AravisClient client(address);
  client.start(16);
  std::uint64_t last = 0;
  for (int i = 0; i < 20; ++i) {
    ArvBuffer* buffer = client.pop(20000);
    ASSERT_NE(buffer, nullptr);
    // A busy machine may miss some, but they come in order, and whole.
    EXPECT_GT(arv_buffer_get_frame_id(buffer), last);
    last = arv_buffer_get_frame_id(buffer);
    if (arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS) expect_exact(buffer);
    client.give_back(buffer);
  }
}

TEST(Gvsim, DescribesItsCoordinates) {
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM, arguments(address));
  AravisClient client(address);
  EXPECT_EQ(client.text("DeviceSerialNumber"), serial_of(address));
  EXPECT_EQ(client.integer("Width"), kWidth);
  EXPECT_EQ(client.text("Scan3dOutputMode"), "ProjectedC");
  client.set("Scan3dCoordinateSelector", "CoordinateC");
  EXPECT_EQ(client.number("Scan3dCoordinateScale"), 0.1);
  EXPECT_EQ(client.number("Scan3dCoordinateOffset"), 0);
  EXPECT_EQ(client.number("Scan3dInvalidDataValue"), 0);
  client.set("Scan3dCoordinateSelector", "CoordinateA");
  EXPECT_EQ(client.number("Scan3dCoordinateScale"), 1);
  EXPECT_EQ(client.number("Scan3dFocalLength"), 1908.6);
  EXPECT_EQ(client.number("Scan3dFocalLength") * client.number("Scan3dAspectRatio"), 1907.9);
  EXPECT_EQ(client.number("Scan3dPrincipalPointU"), 633.2);
  EXPECT_EQ(client.number("Scan3dPrincipalPointV"), 518.4);
  client.set("ComponentSelector", "Intensity");
  EXPECT_EQ(client.text("PixelFormat"), "Mono8");
  EXPECT_EQ(client.integer("ComponentIDValue"), 1);
  client.set("ComponentSelector", "Range");
  EXPECT_EQ(client.text("PixelFormat"), "Coord3D_C16");
  EXPECT_EQ(client.integer("PayloadSize"), kWidth * kHeight * 3);
  EXPECT_THROW(client.set("PixelFormat", "Mono8"), std::runtime_error);  // not for depth
}

TEST(Gvsim, SendsChunksBehindTheImages) {
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM, arguments(address, {"--chunks"}));
  AravisClient client(address);
  client.start();
  for (int i = 0; i < 3; ++i) {
    ArvBuffer* buffer = client.pop(20000);
    ASSERT_NE(buffer, nullptr);
    expect_exact(buffer);
    ASSERT_TRUE(arv_buffer_has_chunks(buffer));
    const auto number = [&](const char* name) {
      return arv_chunk_parser_get_float_value(client.chunks(), buffer, name, nullptr);
    };
    EXPECT_EQ(number("ChunkScan3dFocalLength"), 1908.6);
    EXPECT_EQ(number("ChunkScan3dPrincipalPointV"), 518.4);
    EXPECT_EQ(number("ChunkScan3dCoordinateScale"), 0.1);
    const auto integer = [&](const char* name) {
      return arv_chunk_parser_get_integer_value(client.chunks(), buffer, name, nullptr);
    };
    const auto id = static_cast<gint64>(arv_buffer_get_frame_id(buffer));
    EXPECT_EQ(integer("ChunkFrameID"), id);
    EXPECT_EQ(integer("ChunkImageID"), (id - 1) % 2);
    EXPECT_EQ(integer("ChunkTimestamp"), static_cast<gint64>(arv_buffer_get_timestamp(buffer)));
    client.give_back(buffer);
  }
}

// Without extended ids a block is one image: the components come one after the other.
TEST(Gvsim, SendsOneImageABlockWithStandardIds) {
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM, arguments(address, {"--chunks"}));
  AravisClient client(address);
  client.set("GevGVSPExtendedIDMode", "Off");
  client.start();
  for (int i = 0; i < 6; ++i) {
    ArvBuffer* buffer = client.pop(20000);
    ASSERT_NE(buffer, nullptr);
    ASSERT_EQ(arv_buffer_get_status(buffer), ARV_BUFFER_STATUS_SUCCESS);
    const bool is_depth = arv_buffer_get_image_pixel_format(buffer) == kCoord3dC16;
    const gint64 component = arv_chunk_parser_get_integer_value(client.chunks(), buffer,
                                                                "ChunkComponentIDValue", nullptr);
    EXPECT_EQ(component, is_depth ? 4 : 1);
    const gint64 image =
        arv_chunk_parser_get_integer_value(client.chunks(), buffer, "ChunkImageID", nullptr);
    const std::vector<std::uint8_t> expected =
        image_bytes(1, is_depth ? "depth" : "gray", static_cast<int>(image));
    std::vector<std::uint8_t> got = parts_of(buffer).at(0).bytes;
    ASSERT_GT(got.size(), expected.size());
    got.resize(expected.size());
    EXPECT_TRUE(got == expected) << (is_depth ? "depth" : "gray");
    client.give_back(buffer);
  }
}

TEST(Gvsim, TwoSensorsStreamAtOnce) {
  const std::string addresses[] = {loopback_address(), loopback_address()};
  SimulatorProcess first(GVSIM, arguments(addresses[0]));
  SimulatorProcess second(GVSIM, arguments(addresses[1]));
  AravisClient first_client(addresses[0]), second_client(addresses[1]);
  for (AravisClient* client : {&first_client, &second_client}) {
    use_software_trigger(*client);
    client->start();
  }
  for (int i = 0; i < 5; ++i) {
    first_client.execute("TriggerSoftware");  // on its way while the other one's is
    expect_triggered_frames(second_client, 1);
    ArvBuffer* buffer = first_client.pop(20000);
    ASSERT_NE(buffer, nullptr);
    expect_exact(buffer);
    first_client.give_back(buffer);
  }
}

TEST(Gvsim, IsFoundBySearch) {
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM, arguments(address));
  arv_update_device_list();
  std::string found;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    if (arv_get_device_serial_nbr(i) == serial_of(address)) found = arv_get_device_address(i);
  }
  EXPECT_EQ(found, address);
}

TEST(Gvsim, StopsAtItsLastImageWhenShownOnce) {
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM, arguments(address, {"--once"}));
  {
    AravisClient client(address);
    use_software_trigger(client);
    client.start();
    expect_triggered_frames(client, 2);
    client.execute("TriggerSoftware");
    EXPECT_EQ(client.pop(500), nullptr);
    EXPECT_EQ(client.integer("TriggersMissed"), 1);
  }
  EXPECT_EQ(sim.quit(), 0);
}

}  // namespace
}  // namespace binpick
