#include "modbus/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <thread>

#include "clock.hpp"
#include "command_inbox.hpp"
#include "fake_answers.hpp"
#include "frames.hpp"
#include "raw_client.hpp"
#include "setup_error.hpp"

namespace binpick::modbus {
namespace {

constexpr int kSoonMs = 20'000;  // bounds of what happens at once, on a busy machine

class ServerTest : public testing::Test {
 protected:
  ServerTest() {
    config_.bind_address = "127.0.0.1";
    config_.port = 0;
    config_.frame_timeout_ms = 200;
  }
  void start() {
    server_.emplace(config_, Encoding{}, image_, inbox_);
    server_->start();
  }
  RawClient client(const std::string& source = "127.0.0.1") {
    return RawClient(server_->port(), source);
  }
  void eventually(const std::function<bool()>& happens) {
    const std::int64_t end_ns = app::monotonic_ns() + std::int64_t{kSoonMs} * 1'000'000;
    while (!happens() && app::monotonic_ns() < end_ns) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_TRUE(happens());
  }
  std::uint64_t count(Count what) { return server_->counters()[what]; }

  ServerConfig config_;
  AnswerImage image_;
  CommandInbox inbox_;
  std::optional<Server> server_;
};

Bytes answer_to(RawClient& client, const Bytes& pdu) {
  const auto answer = client.ask(frame_of(pdu));
  return {answer.begin(), answer.end()};
}

const Bytes kRead = frame_of(read_pdu(map::kAnswerStart, map::kAnswerCount));

TEST_F(ServerTest, ShowsAnAnswerWithoutResultFromTheStart) {
  start();
  RawClient reader = client();
  AnswerRegisters registers;
  ASSERT_TRUE(reader.read_answer(registers));
  const auto decoded = decode_answer(registers);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->answer.result_sequence, 0);
  EXPECT_EQ(decoded->answer.cause, map::Cause::kNoResult);
  EXPECT_EQ(decoded->age_ms, kAgeNone);
}

TEST_F(ServerTest, ShowsTheNewestPublishedAnswerToBothFunctions) {
  start();
  RawClient reader = client();
  for (std::uint32_t n : {3U, 4U}) {
    AnswerRegisters published;
    AnswerRegisters holding;
    AnswerRegisters input;
    encode_answer(fake_answer(n), {}, published);
    image_.publish(published, 0);
    ASSERT_TRUE(reader.read_answer(holding, 3));
    ASSERT_TRUE(reader.read_answer(input, 4));
    EXPECT_EQ(holding, published);
    EXPECT_EQ(input, published);
  }
  EXPECT_EQ(count(Count::kReadHolding), 2U);
  EXPECT_EQ(count(Count::kReadInput), 2U);
}

TEST_F(ServerTest, StartsACommandByOneWriteAndOnlyOnce) {
  start();
  RawClient plc = client();
  std::vector<std::uint16_t> block(map::kCommandCount);
  block[map::kAddressCommandCode] = 1;
  block[map::kAddressCommandDeadline] = 400;
  block[map::kAddressCommandSequence] = 9;
  EXPECT_EQ(answer_to(plc, write_many_pdu(0, block)), read_pdu(0, map::kCommandCount, 16));
  TakenCommand command;
  ASSERT_TRUE(inbox_.wait(command, kSoonMs));
  EXPECT_TRUE(std::equal(block.begin(), block.end(), command.registers.begin()));
  EXPECT_GT(command.taken_ns, 0);
  // The same again, as a cyclic writer does, and with a heartbeat that moves.
  block[map::kAddressPlcHeartbeat] = 1;
  answer_to(plc, write_many_pdu(0, block));
  EXPECT_FALSE(inbox_.take(command));
  block[map::kAddressCommandSequence] = 10;
  answer_to(plc, read_write_pdu(100, 125, 0, block));
  EXPECT_TRUE(inbox_.wait(command, kSoonMs));
  EXPECT_EQ(count(Count::kCommands), 2U);
}

TEST_F(ServerTest, StartsNoCommandFromAHalfWrittenBlock) {
  start();
  std::vector<std::uint16_t> block(map::kCommandCount, 1);
  const Bytes whole = frame_of(write_many_pdu(0, block));
  for (const std::size_t cut : {1UL, 6UL, 7UL, 12UL, 20UL, whole.size() - 1}) {
    RawClient plc = client();
    ASSERT_TRUE(plc.send(std::span(whole).first(cut)));
    ::shutdown(plc.fd(), SHUT_WR);
    EXPECT_TRUE(plc.is_closed_within(kSoonMs));
  }
  RawClient plc = client();
  // All but the sequence, register by register and as a block.
  for (int address = 0; address < map::kAddressCommandSequence; ++address) {
    answer_to(plc, write_one_pdu(address, 3));
  }
  answer_to(plc, write_many_pdu(0, std::vector<std::uint16_t>(map::kCommandCount - 1, 2)));
  EXPECT_EQ(count(Count::kCommands), 0U);
  // The sequence last: the parameters are those written before it.
  answer_to(plc, write_one_pdu(map::kAddressCommandSequence, 77));
  TakenCommand command;
  ASSERT_TRUE(inbox_.wait(command, kSoonMs));
  EXPECT_EQ(command.registers[map::kAddressCommandDeadline], 2);
  EXPECT_EQ(command.registers[map::kAddressCommandSequence], 77);
}

TEST_F(ServerTest, LetsOnlyTheWriterWrite) {
  config_.writer = parse_address("127.0.0.9");
  start();
  RawClient reader = client("127.0.0.1");
  RawClient plc = client("127.0.0.9");
  EXPECT_EQ(answer_to(reader, write_one_pdu(19, 5)), (Bytes{0x86, 1}));
  EXPECT_EQ(answer_to(reader, write_many_pdu(0, {1})), (Bytes{0x90, 1}));
  AnswerRegisters registers;
  EXPECT_TRUE(reader.read_answer(registers));
  EXPECT_EQ(count(Count::kCommands), 0U);
  EXPECT_EQ(answer_to(plc, write_one_pdu(19, 5)), write_one_pdu(19, 5));
  EXPECT_EQ(count(Count::kCommands), 1U);
}

TEST_F(ServerTest, LetsInOnlyWhoIsOnTheList) {
  config_.allow = {parse_network("127.0.0.2"), parse_network("127.0.1.0/24")};
  start();
  AnswerRegisters registers;
  EXPECT_TRUE(client("127.0.0.2").read_answer(registers));
  EXPECT_TRUE(client("127.0.1.77").read_answer(registers));
  EXPECT_TRUE(client("127.0.0.3").is_closed_within(kSoonMs));
  EXPECT_TRUE(client("127.0.2.1").is_closed_within(kSoonMs));
  EXPECT_EQ(count(Count::kRefusedAddress), 2U);
}

TEST_F(ServerTest, KeepsItsLimitButFindsAPlaceForTheWriter) {
  config_.clients_max = 2;
  config_.writer = parse_address("127.0.0.9");
  start();
  AnswerRegisters registers;
  RawClient first = client();
  ASSERT_TRUE(first.read_answer(registers));
  RawClient second = client();
  ASSERT_TRUE(second.read_answer(registers));
  EXPECT_TRUE(client().is_closed_within(kSoonMs));
  EXPECT_EQ(count(Count::kRefusedLimit), 1U);
  RawClient plc = client("127.0.0.9");
  EXPECT_TRUE(plc.read_answer(registers));
  EXPECT_TRUE(first.is_closed_within(kSoonMs));  // the one that was silent longest
  EXPECT_TRUE(second.read_answer(registers));
  EXPECT_EQ(server_->client_count(), 2);
}

TEST_F(ServerTest, ClosesWhoBeginsAFrameAndDoesNotEndIt) {
  start();
  RawClient stalling = client();
  ASSERT_TRUE(stalling.send(std::span(kRead).first(5)));
  EXPECT_TRUE(stalling.is_closed_within(kSoonMs));
  RawClient dripping = client();
  for (std::size_t i = 0; i + 1 < kRead.size(); ++i) {  // would take 11 x 50 ms
    if (!dripping.send(std::span(kRead).subspan(i, 1))) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_TRUE(dripping.is_closed_within(kSoonMs));
  EXPECT_EQ(count(Count::kClosedPartialFrame), 2U);
}

TEST_F(ServerTest, ClosesWhoIsSilentTooLong) {
  config_.idle_timeout_ms = 100;
  start();
  RawClient silent = client();
  EXPECT_TRUE(silent.is_closed_within(kSoonMs));
  EXPECT_EQ(count(Count::kClosedIdle), 1U);
}

TEST_F(ServerTest, ClosesWhoDoesNotReadItsAnswers) {
  start();
  RawClient deaf = client();
  const timeval patience{.tv_sec = 0, .tv_usec = 100'000};
  const int small = 4096;
  ::setsockopt(deaf.fd(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
  Bytes many;
  for (int i = 0; i < 100; ++i) many.insert(many.end(), kRead.begin(), kRead.end());
  ::setsockopt(deaf.fd(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  eventually([&] {
    deaf.send(many);
    return count(Count::kClosedUnread) == 1;
  });
}

TEST_F(ServerTest, ClosesWhoSpeaksAnotherProtocol) {
  start();
  RawClient browser = client();
  const std::string request = "GET / HTTP/1.1\r\n\r\n";
  browser.send(Bytes(request.begin(), request.end()));
  EXPECT_TRUE(browser.is_closed_within(kSoonMs));
  RawClient liar = client();
  liar.send(Bytes{0, 1, 0, 0, 255, 255, 1, 3});
  EXPECT_TRUE(liar.is_closed_within(kSoonMs));
  EXPECT_EQ(count(Count::kWrongProtocol), 1U);
  EXPECT_EQ(count(Count::kWrongLength), 1U);
}

TEST_F(ServerTest, AnswersRequestsSentAtOnceInTheirOrder) {
  start();
  RawClient hasty = client();
  Bytes all;
  for (int i = 0; i < 60; ++i) {
    const Bytes one = frame_of(read_pdu(100, 125), i);
    all.insert(all.end(), one.begin(), one.end());
  }
  ASSERT_TRUE(hasty.send(all));
  for (int i = 0; i < 60; ++i) {
    const auto answer = hasty.receive(kSoonMs);
    ASSERT_EQ(answer.size(), 259U);
    EXPECT_EQ(answer[1], i);
  }
}

TEST_F(ServerTest, WatchesTheHeartbeatOfThePlc) {
  config_.plc_heartbeat_timeout_ms = 150;
  start();
  RawClient plc = client();
  EXPECT_EQ(server_->plc_heartbeat(), Heartbeat::kNever);
  answer_to(plc, write_one_pdu(map::kAddressPlcHeartbeat, 1));
  eventually([&] { return server_->plc_heartbeat() == Heartbeat::kLost; });
  answer_to(plc, write_one_pdu(map::kAddressPlcHeartbeat, 1));  // written, not moved
  EXPECT_EQ(server_->plc_heartbeat(), Heartbeat::kLost);
  eventually([&, beat = 1]() mutable {
    answer_to(plc, write_one_pdu(map::kAddressPlcHeartbeat, ++beat));
    return server_->plc_heartbeat() == Heartbeat::kAlive;
  });
}

std::size_t entries_in(const char* folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST_F(ServerTest, StartsAndStopsWithoutLeavingAnythingBehind) {
  std::size_t descriptors = 0;
  std::size_t threads = 0;
  for (int i = 0; i < 100; ++i) {
    start();
    RawClient reader = client();
    AnswerRegisters registers;
    ASSERT_TRUE(reader.read_answer(registers));
    server_->stop();
    EXPECT_TRUE(reader.is_closed_within(kSoonMs));
    server_.reset();
    if (i == 0) {
      descriptors = entries_in("/proc/self/fd");
      threads = entries_in("/proc/self/task");
    }
    ASSERT_EQ(entries_in("/proc/self/fd"), descriptors);
    ASSERT_EQ(entries_in("/proc/self/task"), threads);
  }
}

TEST_F(ServerTest, SaysWhyItCannotStart) {
  start();
  config_.port = server_->port();
  try {
    const Server second(config_, {}, image_, inbox_);
    FAIL() << "two servers on one port";
  } catch (const app::SetupError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(std::to_string(config_.port)));
  }
  config_.bind_address = "localhost";
  EXPECT_THROW(Server(config_, {}, image_, inbox_), app::SetupError);
}

TEST(Network, IsReadFromText) {
  EXPECT_TRUE(parse_network("10.0.0.0/8").contains(parse_address("10.200.3.4")));
  EXPECT_FALSE(parse_network("10.0.0.0/8").contains(parse_address("11.0.0.1")));
  EXPECT_TRUE(parse_network("0.0.0.0/0").contains(parse_address("1.2.3.4")));
  EXPECT_FALSE(parse_network("10.0.0.1").contains(parse_address("10.0.0.2")));
  for (const char* text : {"", "10.0.0", "10.0.0.0/33", "10.0.0.0/", "10.0.0.0/x", "10.0.0.0/-1",
                           "10.0.0.1/8", "host/8", "10.0.0.0/8 "}) {
    EXPECT_THROW(parse_network(text), app::SetupError) << text;
  }
  EXPECT_EQ(address_text(parse_address("10.1.2.3")), "10.1.2.3");
}

}  // namespace
}  // namespace binpick::modbus
