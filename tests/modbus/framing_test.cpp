#include <gtest/gtest.h>

#include <algorithm>

#include "frames.hpp"
#include "modbus/mbap.hpp"
#include "modbus/responder.hpp"

namespace binpick::modbus {
namespace {

using State = FrameReader::State;

State fed(FrameReader& reader, const Bytes& bytes) {
  const auto space = reader.space();
  EXPECT_GE(space.size(), bytes.size());
  std::copy(bytes.begin(), bytes.end(), space.begin());
  reader.added(bytes.size());
  return reader.peek().state;
}

TEST(FrameReader, FindsAFrameInAnyPieces) {
  const Bytes frame = frame_of(read_pdu(100, 125), 0xABCD);
  for (std::size_t cut = 1; cut < frame.size(); ++cut) {
    FrameReader reader;
    EXPECT_EQ(fed(reader, {}), State::kEmpty);
    EXPECT_EQ(fed(reader, Bytes(frame.begin(), frame.begin() + cut)), State::kPartial);
    EXPECT_EQ(fed(reader, Bytes(frame.begin() + cut, frame.end())), State::kFrame);
    EXPECT_TRUE(std::ranges::equal(reader.peek().frame, frame));
    reader.take();
    EXPECT_EQ(reader.peek().state, State::kEmpty);
  }
}

TEST(FrameReader, GivesFramesSentAtOnceOneByOne) {
  FrameReader reader;
  Bytes both = frame_of(read_pdu(0, 1), 1);
  const Bytes second = frame_of(write_many_pdu(0, {1, 2, 3}), 2);
  both.insert(both.end(), second.begin(), second.end());
  both.push_back(0);  // and the first byte of a third
  EXPECT_EQ(fed(reader, both), State::kFrame);
  reader.take();
  EXPECT_TRUE(std::ranges::equal(reader.peek().frame, second));
  reader.take();
  EXPECT_EQ(reader.peek().state, State::kPartial);
}

TEST(FrameReader, RefusesAStreamOfAnythingElseAsSoonAsItCan) {
  for (const auto& [bytes, state] :
       std::initializer_list<std::pair<Bytes, State>>{{{'G', 'E', 'T', ' '}, State::kWrongProtocol},
                                                      {{0, 1, 1}, State::kWrongProtocol},
                                                      {{0, 1, 0, 0, 0, 0}, State::kWrongLength},
                                                      {{0, 1, 0, 0, 0, 1}, State::kWrongLength},
                                                      {{0, 1, 0, 0, 0, 255}, State::kWrongLength},
                                                      {{0, 1, 0, 0, 255, 255}, State::kWrongLength},
                                                      {{0, 1, 0, 0, 0, 254}, State::kPartial}}) {
    FrameReader reader;
    EXPECT_EQ(fed(reader, bytes), state);
  }
}

TEST(FrameReader, HasRoomWheneverNoWholeFrameWaits) {
  FrameReader reader;
  Bytes largest(kFrameBytesMax - kMbapBytes, 3);
  const Bytes frame = frame_of(largest);
  ASSERT_EQ(frame.size(), kFrameBytesMax);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(fed(reader, Bytes(frame.begin(), frame.end() - 1)), State::kPartial);
    EXPECT_FALSE(reader.space().empty());
    EXPECT_EQ(fed(reader, {frame.back()}), State::kFrame);
    reader.take();
  }
}

class ResponderTest : public testing::Test {
 protected:
  // The answer's PDU.
  Bytes ask(const Bytes& pdu, bool may_write = true, int unit = 1) {
    const Bytes frame = frame_of(pdu, 0x1234, unit);
    reply_ = responder_.reply(frame, may_write);
    const Bytes bytes(reply_.bytes.begin(), reply_.bytes.end());
    EXPECT_GE(bytes.size(), 8U);
    EXPECT_EQ((Bytes(bytes.begin(), bytes.begin() + 4)), (Bytes{0x12, 0x34, 0, 0}));
    EXPECT_EQ(bytes[4] << 8 | bytes[5], static_cast<int>(bytes.size()) - 6);
    EXPECT_EQ(bytes[6], unit);
    return {bytes.begin() + 7, bytes.end()};
  }
  void refused(Exception exception, const Bytes& pdu, bool may_write = true, int unit = 1) {
    const auto function = static_cast<std::uint8_t>(pdu[0] | 0x80U);
    EXPECT_EQ(ask(pdu, may_write, unit), (Bytes{function, static_cast<std::uint8_t>(exception)}));
    EXPECT_EQ(reply_.exception, exception);
    EXPECT_FALSE(reply_.wrote);
  }

  Responder responder_{1, {}};
  Responder::Reply reply_;
};

TEST_F(ResponderTest, ReadsWithFunctions3And4Alike) {
  const Bytes holding = ask(read_pdu(100, 125, 3));
  const Bytes input = ask(read_pdu(100, 125, 4));
  ASSERT_EQ(holding.size(), 252U);
  EXPECT_EQ(holding[1], 250);
  EXPECT_TRUE(std::equal(holding.begin() + 1, holding.end(), input.begin() + 1));
  // 102: 0x12345678, before anything was published.
  EXPECT_EQ((Bytes(holding.begin() + 6, holding.begin() + 10)), (Bytes{0x12, 0x34, 0x56, 0x78}));
}

TEST_F(ResponderTest, WritesWithFunctions6And16And23) {
  EXPECT_EQ(ask(write_one_pdu(3, 12)), write_one_pdu(3, 12));
  EXPECT_TRUE(reply_.wrote);
  EXPECT_EQ(responder_.command_registers()[3], 12);
  EXPECT_EQ(ask(write_many_pdu(1, {7, 8})), read_pdu(1, 2, 16));
  EXPECT_EQ(responder_.command_registers()[2], 8);
  EXPECT_EQ(ask(read_write_pdu(0, 3, 0, {5})), (Bytes{23, 6, 0, 5, 0, 7, 0, 8}));
  EXPECT_TRUE(reply_.wrote);
}

TEST_F(ResponderTest, RefusesAddresses) {
  refused(Exception::kIllegalAddress, read_pdu(20, 1));
  refused(Exception::kIllegalAddress, read_pdu(19, 2));
  refused(Exception::kIllegalAddress, read_pdu(99, 2));
  refused(Exception::kIllegalAddress, read_pdu(224, 2));
  refused(Exception::kIllegalAddress, read_pdu(65535, 125));
  refused(Exception::kIllegalAddress, write_one_pdu(100, 1));
  refused(Exception::kIllegalAddress, write_one_pdu(20, 1));
  refused(Exception::kIllegalAddress, write_many_pdu(19, {1, 2}));
  // A block written one address too high: nothing of it arrives.
  refused(Exception::kIllegalAddress, write_many_pdu(1, std::vector<std::uint16_t>(20, 9)));
  for (const std::uint16_t word : responder_.command_registers()) EXPECT_EQ(word, 0);
  refused(Exception::kIllegalAddress, read_write_pdu(50, 1, 0, {1}));
  refused(Exception::kIllegalAddress, read_write_pdu(0, 1, 100, {1}));
}

TEST_F(ResponderTest, RefusesCountsAndLengthsThatContradict) {
  refused(Exception::kIllegalValue, read_pdu(0, 0));
  refused(Exception::kIllegalValue, read_pdu(100, 126));
  refused(Exception::kIllegalValue, {3});
  refused(Exception::kIllegalValue, {3, 0, 0, 0});
  refused(Exception::kIllegalValue, {4, 0, 0, 0, 1, 0});
  refused(Exception::kIllegalValue, {6, 0, 0, 0});
  refused(Exception::kIllegalValue, {16, 0, 0, 0, 2, 4, 0, 1});        // two of four bytes
  refused(Exception::kIllegalValue, {16, 0, 0, 0, 2, 2, 0, 1});        // one of two registers
  refused(Exception::kIllegalValue, {16, 0, 0, 0, 1, 3, 0, 1, 2});     // half a register
  refused(Exception::kIllegalValue, {16, 0, 0, 0, 0, 0});              // none
  refused(Exception::kIllegalValue, {23, 0, 0, 0, 1, 0, 0, 0, 1, 2});  // no value
  refused(Exception::kIllegalValue, read_write_pdu(0, 0, 0, {1}));
  for (const std::uint16_t word : responder_.command_registers()) EXPECT_EQ(word, 0);
}

TEST_F(ResponderTest, RefusesEveryOtherFunction) {
  for (int function = 0; function < 256; ++function) {
    if (function == 3 || function == 4 || function == 6 || function == 16 || function == 23) {
      continue;
    }
    refused(Exception::kIllegalFunction, {static_cast<std::uint8_t>(function), 0, 0, 0, 1});
  }
}

TEST_F(ResponderTest, LetsReadersReadAndNothingElse) {
  refused(Exception::kIllegalFunction, write_one_pdu(0, 1), false);
  refused(Exception::kIllegalFunction, write_many_pdu(0, {1}), false);
  refused(Exception::kIllegalFunction, read_write_pdu(0, 1, 0, {1}), false);
  EXPECT_EQ(ask(read_pdu(0, 1), false), (Bytes{3, 2, 0, 0}));
}

TEST_F(ResponderTest, AnswersItsUnitAndTheTwoThatMeanAnyDevice) {
  EXPECT_EQ(ask(read_pdu(0, 1), true, 0).size(), 4U);
  EXPECT_EQ(ask(read_pdu(0, 1), true, 255).size(), 4U);
  refused(Exception::kTargetSilent, read_pdu(0, 1), true, 2);
}

TEST_F(ResponderTest, ReckonsAgeWhenItIsRead) {
  PublishedAnswer answer;
  encode_answer({}, {}, answer.registers);
  answer.revision = 1;
  responder_.show(answer, 5'000'000'000);
  EXPECT_EQ(ask(read_pdu(map::kAddressAge, 2)), (Bytes{3, 4, 255, 255, 255, 255}));
  answer.revision = 2;
  answer.capture_ns = 1'000'000'000;
  responder_.show(answer, 1'070'000'000);
  EXPECT_EQ(ask(read_pdu(map::kAddressAge, 2)), (Bytes{3, 4, 0, 0, 0, 70}));
  responder_.show(answer, 71'000'000'000);
  EXPECT_EQ(ask(read_pdu(map::kAddressAge, 2)), (Bytes{3, 4, 0, 1, 0x11, 0x70}));
}

}  // namespace
}  // namespace binpick::modbus
