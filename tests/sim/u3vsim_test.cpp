// u3vsim, real libusb and the real Aravis: what arrives is what the files hold, and faults show.
#include <gtest/gtest.h>
#include <libusb.h>

#include <atomic>
#include <cstdlib>
#include <thread>

#include "aravis_client.hpp"
#include "sample_bytes.hpp"
#include "simulator_process.hpp"

namespace binpick {
namespace {

constexpr std::uint32_t kC16 = 0x011000b8, kAbcy16 = 0x82400403;
constexpr std::size_t kPixels = 1280 * 1024;

class U3vsim : public testing::Test {
 protected:
  U3vsim() {
    if (std::getenv("LD_PRELOAD") == nullptr)
      throw std::runtime_error("start this under umockdev-wrapper, as ctest does");
  }

  void start(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"--scenes", kSampleBin, "--scene", "1", "--serial", "U1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    sim_ = std::make_unique<SimulatorProcess>(U3VSIM, arguments);
    const std::string& line = sim_->first_line();
    const std::size_t begin = line.find("UMOCKDEV_DIR=") + 13;
    setenv("UMOCKDEV_DIR", line.substr(begin, line.find(' ', begin) - begin).c_str(), 1);
  }

  static std::unique_ptr<AravisClient> open() {
    arv_update_device_list();
    auto client = std::make_unique<AravisClient>("Binpick-U1");
    client->set("TriggerMode", "On");
    client->start();
    return client;
  }

  // The bytes of the next frame; the status is checked.
  static std::vector<std::uint8_t> frame(AravisClient& client) {
    client.execute("TriggerSoftware");
    ArvBuffer* buffer = client.pop(20000);
    EXPECT_NE(buffer, nullptr);
    if (buffer == nullptr) return {};
    EXPECT_EQ(arv_buffer_get_status(buffer), ARV_BUFFER_STATUS_SUCCESS);
    std::vector<std::uint8_t> bytes = parts_of(buffer).at(0).bytes;
    client.give_back(buffer);
    return bytes;
  }

  // The status of what comes on a trigger; -1: nothing.
  static int status(AravisClient& client, int timeout_ms = 20000) {
    client.execute("TriggerSoftware");
    ArvBuffer* buffer = client.pop(timeout_ms);
    if (buffer == nullptr) return -1;
    const int status = arv_buffer_get_status(buffer);
    client.give_back(buffer);
    return status;
  }

  std::unique_ptr<SimulatorProcess> sim_;
};

TEST_F(U3vsim, SendsTheFilesBytes) {
  start({"--payload", "c16"});
  const auto client = open();
  EXPECT_EQ(client->text("DeviceSerialNumber"), "U1");
  EXPECT_EQ(client->number("Scan3dCoordinateScale"), 0.1);
  EXPECT_EQ(client->integer("PayloadSize"), static_cast<std::int64_t>(2 * kPixels));
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(frame(*client) == image_bytes(1, "depth", i % 2)) << i;
}

TEST_F(U3vsim, SendsDepthAndIntensityInOneImage) {
  start();
  const auto client = open();
  client->execute("TriggerSoftware");
  ArvBuffer* buffer = client->pop(20000);
  ASSERT_NE(buffer, nullptr);
  EXPECT_EQ(arv_buffer_get_image_pixel_format(buffer), kAbcy16);
  const std::vector<std::uint8_t> bytes = parts_of(buffer).at(0).bytes;
  ASSERT_EQ(bytes.size(), 8 * kPixels);
  const std::vector<std::uint8_t>& depth = image_bytes(1, "depth", 0);
  const std::vector<std::uint8_t>& gray = image_bytes(1, "gray", 0);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < kPixels; ++i) {
    const int code = depth[2 * i] | depth[2 * i + 1] << 8;
    const int z = bytes[8 * i + 4] | bytes[8 * i + 5] << 8;
    if (z != (code == 0 ? 65535 : code) || bytes[8 * i + 7] != gray[i]) ++wrong;
  }
  EXPECT_EQ(wrong, 0u);
  client->give_back(buffer);
}

TEST_F(U3vsim, SendsChunks) {
  start({"--payload", "c16", "--chunks"});
  const auto client = open();
  client->execute("TriggerSoftware");
  ArvBuffer* buffer = client->pop(20000);
  ASSERT_NE(buffer, nullptr);
  ASSERT_TRUE(arv_buffer_has_chunks(buffer));
  EXPECT_EQ(arv_buffer_get_image_pixel_format(buffer), kC16);
  EXPECT_EQ(
      arv_chunk_parser_get_float_value(client->chunks(), buffer, "ChunkScan3dFocalLength", nullptr),
      1908.6);
  EXPECT_EQ(arv_chunk_parser_get_integer_value(client->chunks(), buffer, "ChunkFrameID", nullptr),
            1);
  client->give_back(buffer);
}

TEST_F(U3vsim, ShortPayloadIsNoSuccess) {
  start({"--payload", "c16"});
  const auto client = open();
  EXPECT_EQ(status(*client), ARV_BUFFER_STATUS_SUCCESS);
  ASSERT_EQ(sim_->tell("fault short-payload 1"), "ok");
  EXPECT_NE(status(*client, 1000), ARV_BUFFER_STATUS_SUCCESS);
}

TEST_F(U3vsim, WrongTrailerIsNoSuccess) {
  start({"--payload", "c16"});
  const auto client = open();
  ASSERT_EQ(sim_->tell("fault wrong-trailer 1"), "ok");
  EXPECT_NE(status(*client), ARV_BUFFER_STATUS_SUCCESS);
  ASSERT_EQ(sim_->tell("clear"), "ok");
  EXPECT_EQ(status(*client), ARV_BUFFER_STATUS_SUCCESS);
}

TEST_F(U3vsim, StalledStreamGivesNoGoodFrame) {
  start({"--payload", "c16"});
  const auto client = open();
  ASSERT_EQ(sim_->tell("fault stall 1"), "ok");
  EXPECT_NE(status(*client, 1000), ARV_BUFFER_STATUS_SUCCESS);
}

TEST_F(U3vsim, StoppedStreamSendsNothing) {
  start({"--payload", "c16"});
  const auto client = open();
  ASSERT_EQ(sim_->tell("fault stop-stream 1"), "ok");
  EXPECT_EQ(status(*client, 500), -1);
  ASSERT_EQ(sim_->tell("clear"), "ok");
  EXPECT_EQ(status(*client), ARV_BUFFER_STATUS_SUCCESS);
}

TEST_F(U3vsim, FrozenAnswersNothingAndThaws) {
  start({"--payload", "c16"});
  const auto client = open();
  ASSERT_EQ(sim_->tell("fault frozen 1"), "ok");
  EXPECT_THROW(client->execute("TriggerSoftware"), std::runtime_error);
  ASSERT_EQ(sim_->tell("fault frozen 0"), "ok");
  EXPECT_EQ(status(*client), ARV_BUFFER_STATUS_SUCCESS);
}

TEST_F(U3vsim, RefusesWrites) {
  start();
  auto client = open();
  ASSERT_EQ(sim_->tell("fault refuse 1"), "ok");
  EXPECT_THROW(client->set("TriggerMode", "Off"), std::runtime_error);
  ASSERT_EQ(sim_->tell("fault refuse 0"), "ok");
  client->set("TriggerMode", "Off");
}

void set_flag(ArvDevice*, gpointer flag) {
  static_cast<std::atomic<bool>*>(flag)->store(true);
}

TEST_F(U3vsim, IsLostWhenUnpluggedAndBackWhenPlugged) {
  start({"--payload", "c16"});
  std::atomic<bool> lost{false};
  {
    const auto client = open();
    EXPECT_TRUE(frame(*client) == image_bytes(1, "depth", 0));
    g_signal_connect(client->device(), "control-lost", G_CALLBACK(set_flag), &lost);
    ASSERT_EQ(sim_->tell("unplug"), "ok");
    for (int i = 0; i < 200 && !lost; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_TRUE(lost);
  }
  arv_update_device_list();
  for (unsigned i = 0; i < arv_get_n_devices(); ++i)
    EXPECT_STRNE(arv_get_device_serial_nbr(i), "U1");  // sensors on the network are no matter
  ASSERT_EQ(sim_->tell("plug"), "ok");
  const auto client = open();
  EXPECT_TRUE(frame(*client) == image_bytes(1, "depth", 0));
}

struct BusPlace {
  int speed = 0, bus = 0;
  std::vector<int> ports;
};

// Of the camera, as libusb has it.
BusPlace camera_place() {
  BusPlace place;
  libusb_context* usb = nullptr;
  libusb_init(&usb);
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(usb, &list);
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor;
    libusb_get_device_descriptor(list[i], &descriptor);
    if (descriptor.bDeviceClass != 0xef) continue;
    std::uint8_t ports[8];
    const int port_count = libusb_get_port_numbers(list[i], ports, 8);
    place.speed = libusb_get_device_speed(list[i]);
    place.bus = libusb_get_bus_number(list[i]);
    place.ports.assign(ports, ports + std::max(port_count, 0));
  }
  libusb_free_device_list(list, 1);
  libusb_exit(usb);
  return place;
}

TEST_F(U3vsim, SitsInItsPort) {
  start();
  const BusPlace place = camera_place();
  EXPECT_EQ(place.speed, LIBUSB_SPEED_SUPER);
  EXPECT_EQ(place.bus, 2);
  EXPECT_EQ(place.ports, std::vector<int>{3});
}

TEST_F(U3vsim, ShowsAPortOfUsb2) {
  start({"--usb2"});
  const BusPlace place = camera_place();
  EXPECT_EQ(place.speed, LIBUSB_SPEED_HIGH);
  EXPECT_EQ(place.bus, 1);
}

}  // namespace
}  // namespace binpick
