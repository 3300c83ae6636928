#include "plc/invariants.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_answers.hpp"
#include "plc/answer_text.hpp"

namespace binpick::plc {
namespace {

using modbus::AnswerRegisters;
using modbus::AnswerSnapshot;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace map = modbus::map;

constexpr std::int64_t kMs = 1'000'000;

class InvariantsTest : public testing::Test {
 protected:
  InvariantsTest() {
    answer_ = modbus::fake_answer(10);
    answer_.acknowledged_sequence = answer_.result_command = 10;
    read();
  }
  // What `answer_` says, read `ms` later; each read moves the heartbeat and ages the frame.
  void read(std::int64_t ms = 20) {
    now_ns_ += ms * kMs;
    age_ms_ += ms;
    ++answer_.station_heartbeat;
    AnswerRegisters registers;
    modbus::encode_answer(answer_, {}, registers);
    modbus::put_age(registers, map::WordOrder::kAbcd, static_cast<std::uint32_t>(age_ms_));
    invariants_.read(registers, now_ns_ - kMs, now_ns_);
  }
  void answer_to_detect(std::int64_t frame_age_ms) {
    invariants_.command_sent(11, map::CommandCode::kDetect, now_ns_);
    answer_.acknowledged_sequence = answer_.result_command = 11;
    answer_.result_sequence = modbus::next_sequence(answer_.result_sequence);
    ++answer_.capture_unix_ms;
    age_ms_ = frame_age_ms;
    read();
  }

  Invariants invariants_{{}};
  AnswerSnapshot answer_;
  std::int64_t now_ns_ = 1'000'000 * kMs;
  std::int64_t age_ms_ = 0;
};

TEST_F(InvariantsTest, HoldForAStationThatBehaves) {
  for (int i = 0; i < 50; ++i) read();
  answer_to_detect(0);
  for (int i = 0; i < 50; ++i) read();
  EXPECT_THAT(invariants_.faults(), IsEmpty());
}

TEST_F(InvariantsTest, NoticeAResultThatChangesUnderItsSequence) {
  ++answer_.detections;
  read();
  EXPECT_THAT(invariants_.faults(), ElementsAre(HasSubstr("115 (40116)")));
}

TEST_F(InvariantsTest, NoticeSequencesThatJump) {
  answer_.result_sequence = static_cast<std::uint16_t>(answer_.result_sequence + 2);
  read();
  EXPECT_THAT(invariants_.faults(), ElementsAre(HasSubstr("went from 11 to 13")));
}

TEST_F(InvariantsTest, NoticeAnotherPlc) {
  answer_.acknowledged_sequence = 4711;
  read();
  EXPECT_THAT(invariants_.faults(), ElementsAre(HasSubstr("another PLC")));
}

TEST_F(InvariantsTest, NoticeAHeartbeatThatStands) {
  for (int i = 0; i < 20; ++i) {
    --answer_.station_heartbeat;
    read(100);
  }
  EXPECT_THAT(invariants_.faults(), ElementsAre(HasSubstr("stands still")));
}

TEST_F(InvariantsTest, NoticeAnAgeThatDoesNotGrow) {
  age_ms_ -= 500;
  read();
  EXPECT_THAT(invariants_.faults(), ElementsAre(HasSubstr("age grew")));
}

TEST_F(InvariantsTest, NoticeAnOldFrame) {
  answer_to_detect(5000);
  EXPECT_THAT(invariants_.faults(), ElementsAre(HasSubstr("stale")));
}

TEST_F(InvariantsTest, SayWhyAReadIsNotWhole) {
  AnswerRegisters good;
  modbus::encode_answer(answer_, {}, good);
  EXPECT_EQ(why_not_whole(good), "");
  AnswerRegisters shifted{};
  std::copy(good.begin() + 1, good.end(), shifted.begin());
  EXPECT_THAT(why_not_whole(shifted), HasSubstr("-1 registers off"));
  AnswerRegisters torn = good;
  ++torn.back();
  EXPECT_THAT(why_not_whole(torn), HasSubstr("torn"));
  AnswerRegisters other = good;
  ++other[1];
  EXPECT_THAT(why_not_whole(other), HasSubstr("checksum"));
  EXPECT_THAT(why_not_whole(AnswerRegisters{}), HasSubstr("no binpick station"));
}

}  // namespace
}  // namespace binpick::plc
