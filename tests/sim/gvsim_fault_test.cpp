// Each fault of gvsim, as it shows at the wire.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "raw_gev_host.hpp"
#include "simulator_process.hpp"
#include "tiny_scene.hpp"

namespace binpick {
namespace {

constexpr std::uint32_t kPacketSize = 576;
constexpr std::size_t kPacketData = kPacketSize - 28 - 20 - 8;  // of a multipart packet
constexpr std::size_t kBlockBytes = TinyScene::kWidth * TinyScene::kHeight * 3;

class GvsimFault : public testing::Test {
 protected:
  GvsimFault() { host_.start(kPacketSize); }

  void set(const std::string& fault) { ASSERT_EQ(sim_.tell("fault " + fault), "ok"); }

  std::vector<StreamPacket> frame(int first_ms = 10000) {
    host_.trigger();
    return host_.packets(first_ms);
  }

  // Data as a host puts them together; empty when they do not fit.
  static std::vector<std::uint8_t> assembled(const std::vector<StreamPacket>& packets) {
    std::vector<std::uint8_t> bytes(kBlockBytes);
    for (const StreamPacket& packet : packets) {
      if (packet.content != 7) continue;
      if (packet.offset + packet.payload.size() > bytes.size()) return {};
      std::copy(packet.payload.begin(), packet.payload.end(),
                bytes.begin() + static_cast<std::ptrdiff_t>(packet.offset));
    }
    return bytes;
  }

  static std::set<std::uint32_t> numbers(const std::vector<StreamPacket>& packets) {
    std::set<std::uint32_t> all;
    for (const StreamPacket& packet : packets) all.insert(packet.number);
    return all;
  }

  // A frame without fault, after faults.
  void expect_whole_frame() {
    ASSERT_EQ(sim_.tell("clear"), "ok");
    const std::vector<StreamPacket> packets = frame();
    ASSERT_FALSE(packets.empty());
    EXPECT_EQ(assembled(packets),
              TinyScene::block_bytes(static_cast<int>((packets.front().block_id - 1) % 3)));
  }

  std::uint32_t leader_word(const std::vector<StreamPacket>& packets, std::size_t at) {
    const std::vector<std::uint8_t>& leader = packets.at(0).payload;
    return std::uint32_t{leader.at(at)} << 24 | std::uint32_t{leader.at(at + 1)} << 16 |
           std::uint32_t{leader.at(at + 2)} << 8 | leader.at(at + 3);
  }

  TinyScene scene_{3};
  std::string address_ = loopback_address();
  SimulatorProcess sim_{GVSIM, {"--bind", address_, "--scenes", scene_.path()}};
  RawGevHost host_{address_};
};

TEST_F(GvsimFault, NoneGivesLeaderDataAndTrailerInOrder) {
  for (int image : {0, 1, 2, 0}) {
    const std::vector<StreamPacket> packets = frame();
    ASSERT_GT(packets.size(), 2u);
    EXPECT_EQ(packets.front().content, 1);
    EXPECT_EQ(packets.front().part_count, 2);
    EXPECT_EQ(packets.back().content, 2);
    for (std::size_t i = 0; i < packets.size(); ++i) EXPECT_EQ(packets[i].number, i);
    EXPECT_EQ(assembled(packets), TinyScene::block_bytes(image));
  }
}

TEST_F(GvsimFault, LossLosesPacketsAndResendBringsThem) {
  const std::size_t whole = frame().size();
  set("loss 1");
  EXPECT_TRUE(frame(300).empty());
  EXPECT_EQ(sim_.counter("lost"), static_cast<long long>(whole));
  ASSERT_EQ(sim_.tell("clear"), "ok");
  host_.ask_again(2, 0, static_cast<std::uint32_t>(whole - 1));
  const std::vector<StreamPacket> again = host_.packets();
  ASSERT_EQ(again.size(), whole);
  EXPECT_EQ(assembled(again), TinyScene::block_bytes(1));
}

TEST_F(GvsimFault, ResendOfWhatIsGoneIsAnsweredWithUnavailable) {
  frame();
  host_.ask_again(77, 3, 3);
  const std::vector<StreamPacket> answer = host_.packets();
  ASSERT_EQ(answer.size(), 1u);
  EXPECT_EQ(answer[0].status, 0x800c);
  EXPECT_EQ(answer[0].block_id, 77u);
  EXPECT_EQ(answer[0].number, 3u);
}

TEST_F(GvsimFault, ReorderedPacketsAreAllThere) {
  set("reorder 0.5");
  const std::vector<StreamPacket> packets = frame();
  EXPECT_FALSE(std::is_sorted(packets.begin(), packets.end(),
                              [](const auto& a, const auto& b) { return a.number < b.number; }));
  EXPECT_EQ(numbers(packets).size(), packets.size());
  EXPECT_EQ(assembled(packets), TinyScene::block_bytes(0));
  expect_whole_frame();
}

TEST_F(GvsimFault, DuplicatesComeTwice) {
  set("duplicate 1");
  const std::vector<StreamPacket> packets = frame();
  EXPECT_EQ(2 * numbers(packets).size(), packets.size());
  EXPECT_EQ(assembled(packets), TinyScene::block_bytes(0));
}

TEST_F(GvsimFault, TruncatedPacketsEndInTheirData) {
  set("truncate 1");
  const std::vector<StreamPacket> packets = frame();
  ASSERT_GT(packets.size(), 2u);
  EXPECT_EQ(packets[1].payload.size(), kPacketData / 2);
  EXPECT_NE(assembled(packets), TinyScene::block_bytes(0));
  expect_whole_frame();
}

TEST_F(GvsimFault, CorruptPacketsHaveTheirSizeButNotTheirData) {
  set("corrupt 1");
  const std::vector<StreamPacket> packets = frame();
  ASSERT_GT(packets.size(), 2u);
  EXPECT_EQ(packets[1].payload.size(), kPacketData);
  std::vector<std::uint8_t> inverted = TinyScene::block_bytes(0);
  for (std::uint8_t& byte : inverted) byte = static_cast<std::uint8_t>(~byte);
  EXPECT_EQ(assembled(packets), inverted);
  expect_whole_frame();
}

TEST_F(GvsimFault, WrongIdsAreThoseOfOthers) {
  const std::size_t whole = frame().size();
  set("wrong-id 0.5");
  const std::vector<StreamPacket> packets = frame();
  EXPECT_EQ(packets.size(), whole);
  EXPECT_LT(numbers(packets).size(), whole);
  expect_whole_frame();
}

TEST_F(GvsimFault, WrongSizesAreTooLarge) {
  set("wrong-size 1");
  const std::vector<StreamPacket> packets = frame();
  ASSERT_GT(packets.size(), 2u);
  EXPECT_EQ(packets[1].payload.size(), kPacketData + 16);
  expect_whole_frame();
}

TEST_F(GvsimFault, LeadersLie) {
  // Behind flags, payload type and time: part type, length; at 24 and 28 width and height.
  set("lying-width 1");
  EXPECT_EQ(leader_word(frame(), 12 + 24), 2u * TinyScene::kWidth);
  ASSERT_EQ(sim_.tell("clear"), "ok");
  set("lying-height 1");
  EXPECT_EQ(leader_word(frame(), 12 + 28), 2u * TinyScene::kHeight);
  ASSERT_EQ(sim_.tell("clear"), "ok");
  set("lying-size 1");
  EXPECT_EQ(leader_word(frame(), 12 + 4), 2u * 2 * TinyScene::kWidth * TinyScene::kHeight);
  ASSERT_EQ(sim_.tell("clear"), "ok");
  set("lying-offset 1");
  EXPECT_GE(frame().at(1).offset, kBlockBytes);
  expect_whole_frame();
}

TEST_F(GvsimFault, FrozenAnswersNothingAndThaws) {
  set("frozen 1");
  EXPECT_FALSE(host_.command(0x80, big_endian({0x0a00}), 1, 300));
  EXPECT_TRUE(host_.packets(100).empty());
  set("frozen 0");
  EXPECT_TRUE(host_.read(0x0a00));
}

TEST_F(GvsimFault, RefusesControl) {
  EXPECT_EQ(host_.read(0x0a00), 2u);
  set("refuse 1");
  EXPECT_EQ(host_.read(0x0a00), 0u);  // the host has lost it
  EXPECT_EQ(host_.write(0x0a00, 2), 0x8006);
  EXPECT_EQ(host_.write(0x10024, 1), 0x8006);
  set("refuse 0");
  EXPECT_EQ(host_.write(0x0a00, 2), 0);
}

TEST_F(GvsimFault, StopsTheStreamButAnswers) {
  set("stop-stream 1");
  EXPECT_TRUE(frame(300).empty());
  EXPECT_EQ(host_.read(0x0a00), 2u);
  expect_whole_frame();
}

TEST_F(GvsimFault, SlowFramesComeLater) {
  set("slow 400");
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(frame().empty());
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(400));
}

TEST_F(GvsimFault, LosesTheFirstFrameAfterAnIdleGap) {
  set("idle 30");
  EXPECT_FALSE(frame().empty());  // no gap yet
  set("idle 0.001");
  EXPECT_TRUE(frame(300).empty());
  set("idle 30");
  EXPECT_FALSE(frame().empty());
}

TEST_F(GvsimFault, KilledSaysNoGoodbye) {
  sim_.tell("kill");
  EXPECT_FALSE(host_.command(0x80, big_endian({0x0a00}), 1, 300));
}

TEST_F(GvsimFault, WhatIsNotUnderstoodIsSaid) {
  EXPECT_EQ(sim_.tell("fault loss 1.5"), "err loss takes a number from 0 to 1");
  EXPECT_EQ(sim_.tell("fault loss x"), "err loss takes a number from 0 to 1");
  EXPECT_EQ(sim_.tell("fault short-payload 1"),
            "err there is no fault 'short-payload' (see --help)");
  EXPECT_EQ(sim_.tell("dance"), "err not understood (see --help)");
  EXPECT_EQ(sim_.tell("fault loss 0.25"), "ok");
  EXPECT_NE(sim_.tell("status").find("faults: loss=0.25"), std::string::npos);
}

}  // namespace
}  // namespace binpick
