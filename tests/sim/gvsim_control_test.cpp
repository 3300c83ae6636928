// gvsim's control channel: who may do what, and what is said to those who may not.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "raw_gev_host.hpp"
#include "simulator_process.hpp"
#include "tiny_scene.hpp"

namespace binpick {
namespace {

constexpr std::uint32_t kPrivilege = 0x0a00, kHeartbeat = 0x0938, kTriggerMode = 0x10018;
constexpr int kOk = 0, kNotImplemented = 0x8001, kInvalidParameter = 0x8002;
constexpr int kInvalidAddress = 0x8003, kWriteProtect = 0x8004, kBadAlignment = 0x8005;
constexpr int kAccessDenied = 0x8006, kBusy = 0x8007, kInvalidHeader = 0x800e;

class GvsimControl : public testing::Test {
 protected:
  TinyScene scene_{1};
  std::string address_ = loopback_address();
  SimulatorProcess sim_{
      GVSIM, {"--bind", address_, "--scenes", scene_.path(), "--serial", "C1", "--model", "Eye"}};
  RawGevHost host_{address_}, other_{address_};
};

TEST_F(GvsimControl, IsDiscovered) {
  const auto answer = host_.command(0x0002, {}, 0x11);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, kOk);
  EXPECT_EQ(answer->command, 0x0003);
  ASSERT_EQ(answer->payload.size(), 0xf8u);
  EXPECT_STREQ(reinterpret_cast<const char*>(&answer->payload[0x68]), "Eye");
  EXPECT_STREQ(reinterpret_cast<const char*>(&answer->payload[0xd8]), "C1");
  EXPECT_EQ(answer->payload[0x24], 127);
}

TEST_F(GvsimControl, OnlyTheControllingHostWrites) {
  EXPECT_EQ(host_.write(kTriggerMode, 1), kAccessDenied);  // nobody is in control
  EXPECT_EQ(host_.write(kPrivilege, 2), kOk);
  EXPECT_EQ(host_.write(kTriggerMode, 1), kOk);
  EXPECT_EQ(other_.write(kTriggerMode, 0), kAccessDenied);
  EXPECT_EQ(other_.write(kPrivilege, 2), kAccessDenied);
  EXPECT_EQ(other_.read(kTriggerMode), 1u);  // reading is free
  EXPECT_EQ(host_.write(kPrivilege, 0), kOk);
  EXPECT_EQ(other_.write(kPrivilege, 2), kOk);
}

TEST_F(GvsimControl, ExclusiveAccessShutsOthersOut) {
  EXPECT_EQ(host_.write(kPrivilege, 1), kOk);
  EXPECT_EQ(host_.read(kTriggerMode), 0u);
  EXPECT_EQ(other_.read_status(kTriggerMode), kAccessDenied);
  const auto memory = other_.command(0x84, big_endian({0x48, 32}));
  ASSERT_TRUE(memory);
  EXPECT_EQ(memory->status, kAccessDenied);
  EXPECT_EQ(other_.read(kPrivilege), 1u);  // but who is in control may be asked
}

TEST_F(GvsimControl, ControlEndsWithTheHeartbeat) {
  EXPECT_EQ(host_.write(kPrivilege, 2), kOk);
  EXPECT_EQ(host_.write(kHeartbeat, 100), kInvalidParameter);
  EXPECT_EQ(host_.write(kHeartbeat, 500), kOk);
  for (int i = 0; i < 100 && other_.read(kPrivilege) != 0u; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(other_.read(kPrivilege), 0u);
  EXPECT_EQ(sim_.counter("heartbeats_lost"), 1);
  EXPECT_EQ(other_.write(kPrivilege, 2), kOk);
}

TEST_F(GvsimControl, SaysWhatIsWrongWithAnAccess) {
  EXPECT_EQ(host_.write(kPrivilege, 2), kOk);
  EXPECT_EQ(host_.read_status(0x0a02), kBadAlignment);
  EXPECT_EQ(host_.read_status(0x9000000), kInvalidAddress);
  EXPECT_EQ(host_.write(0x10060, 5), kWriteProtect);       // the sensor's width
  EXPECT_EQ(host_.write(0x10000, 0), kInvalidParameter);   // the region's
  EXPECT_EQ(host_.write(0x10008, 1), kInvalidParameter);   // offset, with the whole width
  EXPECT_EQ(host_.write(0x10018, 2), kInvalidParameter);   // trigger mode
  EXPECT_EQ(host_.write(0x10120, 77), kInvalidParameter);  // pixel format
  EXPECT_EQ(host_.write(0x0d04, 100), kInvalidParameter);  // packet size
  EXPECT_EQ(host_.command(0x80, {1, 2, 3})->status, kInvalidHeader);
  EXPECT_EQ(host_.command(0x84, big_endian({0x48, 4096}))->status, kInvalidParameter);
  EXPECT_EQ(host_.command(0x0004, std::vector<std::uint8_t>(56))->status, kAccessDenied);
  EXPECT_EQ(host_.command(0x0100, {})->status, kNotImplemented);
}

TEST_F(GvsimControl, FormatsStayWhileFramesAreAcquired) {
  host_.start(576);
  EXPECT_EQ(host_.write(0x10124, 0x01100007), kBusy);
  EXPECT_EQ(host_.write(0x10000, 640), kBusy);
  EXPECT_EQ(host_.write(0x10030, 1), kOk);  // stop
  EXPECT_EQ(host_.write(0x10124, 0x01100007), kOk);
}

TEST_F(GvsimControl, ReadsAndWritesMemory) {
  EXPECT_EQ(host_.write(kPrivilege, 2), kOk);
  std::vector<std::uint8_t> payload = big_endian({0xe8});
  const std::string name = "north bin";
  payload.insert(payload.end(), name.begin(), name.end());
  payload.resize(4 + 16);
  EXPECT_EQ(host_.command(0x86, payload)->status, kOk);
  const auto answer = host_.command(0x84, big_endian({0xe8, 16}));
  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->payload.size(), 20u);
  EXPECT_STREQ(reinterpret_cast<const char*>(&answer->payload[4]), name.c_str());
}

TEST_F(GvsimControl, StreamsNothingWhenControlIsReleased) {
  host_.start(576);
  host_.trigger();
  EXPECT_FALSE(host_.packets().empty());
  EXPECT_EQ(sim_.tell("release"), "ok");
  EXPECT_EQ(host_.write(0x10024, 1), kAccessDenied);
  EXPECT_EQ(sim_.counter("acquiring"), 0);
}

}  // namespace
}  // namespace binpick
