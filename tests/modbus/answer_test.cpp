#include "modbus/answer.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "fake_answers.hpp"
#include "modbus/answer_image.hpp"

namespace binpick::modbus {
namespace {

std::uint16_t at(const AnswerRegisters& registers, int address) {
  return registers[static_cast<std::size_t>(address - map::kAnswerStart)];
}

TEST(Answer, HasItsConstantsAndSequencesWhereTheMapSays) {
  AnswerRegisters r;
  encode_answer(fake_answer(40), {}, r);
  EXPECT_EQ(at(r, 100), map::kVersion);
  EXPECT_EQ(at(r, 101), map::kChecksum);
  EXPECT_EQ(at(r, 102), 0x1234);
  EXPECT_EQ(at(r, 103), 0x5678);
  EXPECT_EQ(at(r, 104), 0x3F80);
  EXPECT_EQ(at(r, 105), 0);
  EXPECT_EQ(at(r, 106), 0xFFFF);
  EXPECT_EQ(at(r, 111), 41);
  EXPECT_EQ(at(r, 224), 41);
  EXPECT_EQ(at(r, 118), 5);
  EXPECT_EQ(at(r, 128 + 1), 40);  // first pick, x: 0.040 mm
  EXPECT_EQ(at(r, 128 + 15), 1);  // and its valid flag
  EXPECT_EQ(at(r, 128 + 6 * 16 - 1), 0);
}

TEST(Answer, ComesBackWhole) {
  for (std::uint32_t n : {0U, 1U, 6U, 65535U, 70000U, 123456789U}) {
    AnswerRegisters r;
    const Encoding encoding{.word_order = map::WordOrder::kCdab,
                            .rotation = map::RotationConvention::kQuaternionWxyz};
    encode_answer(fake_answer(n), encoding, r);
    EXPECT_TRUE(is_whole(r, encoding)) << n;
    const auto decoded = decode_answer(r);
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded->answer.capture_unix_ms, 1'700'000'000'000 + n);
    EXPECT_EQ(decoded->age_ms, kAgeNone);
  }
}

TEST(Answer, IsNotDecodedWhenAnythingIsTorn) {
  AnswerRegisters good;
  encode_answer(fake_answer(5), {}, good);
  ASSERT_TRUE(decode_answer(good));
  for (const int address : {100, 101, 102, 103, 104, 106, 111, 224, 118, 128 + 15}) {
    AnswerRegisters r = good;
    r[static_cast<std::size_t>(address - map::kAnswerStart)] ^= 0x8001U;
    EXPECT_FALSE(decode_answer(r)) << address;
  }
  // The second half of another answer.
  AnswerRegisters other;
  encode_answer(fake_answer(6), {}, other);
  std::copy(other.begin() + 60, other.end(), good.begin() + 60);
  EXPECT_FALSE(decode_answer(good));
}

TEST(Answer, MarksPicksThatAreNoPosesAsInvalid) {
  AnswerSnapshot answer = fake_answer(1);
  answer.page_picks[0].T_ref_part.t_mm.x() = std::nan("");
  AnswerRegisters r;
  encode_answer(answer, {}, r);
  for (int address = 128; address < 144; ++address) EXPECT_EQ(at(r, address), 0);
}

TEST(Answer, ShowsNoPicksWithACommandThatWasRefusedOrFailed) {
  AnswerSnapshot answer = fake_answer(5);
  answer.cause = map::Cause::kSensorLost;
  AnswerRegisters r;
  encode_answer(answer, {}, r);
  for (int address = 128; address < 224; ++address) EXPECT_EQ(at(r, address), 0);
  const auto decoded = decode_answer(r);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->answer.picks, 0);
  EXPECT_EQ(decoded->answer.page_pick_count, 0);
}

TEST(Answer, HoldsLongTimesAtTheirEnds) {
  AnswerSnapshot answer;
  answer.cycle_time_ms = 1'000'000;
  AnswerRegisters r;
  encode_answer(answer, {}, r);
  EXPECT_EQ(at(r, map::kAddressCycleTime), 65535);
}

TEST(Answer, SequencesLeaveOutZero) {
  EXPECT_EQ(next_sequence(0), 1);
  EXPECT_EQ(next_sequence(65534), 65535);
  EXPECT_EQ(next_sequence(65535), 1);
}

TEST(Answer, PagesHoldSixPicks) {
  EXPECT_EQ(page_count(0), 1);
  EXPECT_EQ(page_count(6), 1);
  EXPECT_EQ(page_count(7), 2);
  EXPECT_EQ(page_count(12), 2);
}

TEST(AnswerImage, GivesTheNewestAnswerWholeAndNeverAnOlderOne) {
  AnswerImage image;
  EXPECT_EQ(image.latest().revision, 0U);
  constexpr std::uint32_t kAnswers = 200'000;
  std::atomic<bool> done{false};
  std::thread publisher([&] {
    AnswerRegisters registers;
    for (std::uint32_t n = 1; n <= kAnswers; ++n) {
      encode_answer(fake_answer(n), {}, registers);
      image.publish(registers, n);
    }
    done = true;
  });
  std::uint64_t last = 0;
  int seen = 0;
  while (last < kAnswers) {
    const bool was_done = done;
    const PublishedAnswer& answer = image.latest();
    if (answer.revision != 0) {
      ASSERT_GE(answer.revision, last);
      ASSERT_TRUE(is_whole(answer.registers, {})) << answer.revision;
      ASSERT_EQ(static_cast<std::uint64_t>(answer.capture_ns), answer.revision);
      seen += answer.revision != last ? 1 : 0;
    }
    last = answer.revision;
    ASSERT_FALSE(was_done && last != kAnswers) << "the last one published is not seen";
  }
  publisher.join();
  EXPECT_GT(seen, 1);
}

}  // namespace
}  // namespace binpick::modbus
