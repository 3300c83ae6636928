// The server takes nothing from the heap once it runs, whatever its clients do; nor does the side
// that publishes answers and takes commands.
#include <gtest/gtest.h>

#include "command_inbox.hpp"
#include "core/allocation_count.hpp"
#include "fake_answers.hpp"
#include "frames.hpp"
#include "modbus/server.hpp"
#include "raw_client.hpp"

namespace binpick::modbus {
namespace {

TEST(Server, AllocatesNothingOnceItRuns) {
  if (!allocations_counted()) GTEST_SKIP() << "a sanitizer holds malloc";
  AnswerImage image;
  CommandInbox inbox;
  ServerConfig config;
  config.bind_address = "127.0.0.1";
  config.port = 0;
  config.frame_timeout_ms = 20;
  Server server(config, {}, image, inbox);
  server.start();
  std::vector<Bytes> requests = {
      frame_of(read_pdu(100, 125)),  frame_of(read_pdu(100, 125, 4)),
      frame_of(write_one_pdu(0, 1)), frame_of(read_write_pdu(100, 125, 0, {1, 2, 3})),
      frame_of(read_pdu(0, 126)),    frame_of(read_pdu(0, 1), 1, 9),
      frame_of({1, 0, 0, 0, 1}),     frame_of({3})};
  Bytes command = frame_of(write_many_pdu(0, std::vector<std::uint16_t>(20, 1)));
  const Bytes nonsense = {'n', 'o', 't', ' ', 'm', 'o', 'd', 'b', 'u', 's'};
  const std::string address = "127.0.0.1";
  AnswerRegisters registers;
  TakenCommand taken;
  std::uint32_t n = 0;
  int commands = 0;
  const auto cycle = [&] {
    RawClient client(server.port(), address);
    for (int i = 0; i < 20; ++i) {
      encode_answer(fake_answer(++n), {}, registers);
      image.publish(registers, n);
      for (const Bytes& request : requests) ASSERT_FALSE(client.ask(request).empty());
      command.back() = static_cast<std::uint8_t>(1 + n % 250);
      ASSERT_FALSE(client.ask(command).empty());
      if (!inbox.wait(taken, 5000)) continue;
      const auto decoded = decode_command(taken.registers, {}, {});
      commands += decoded.sequence == 1 + n % 250 ? 1 : 0;
    }
    if (n % 3 == 0) client.send(nonsense);
    if (n % 3 == 1) {
      client.send(std::span(command).first(9));
      client.is_closed_within(5000);
    }
  };
  for (int i = 0; i < 3; ++i) cycle();  // what the C library makes once
  const long long before = allocation_count();
  for (int i = 0; i < 100; ++i) cycle();
  EXPECT_EQ(allocation_count() - before, 0);
  EXPECT_EQ(commands, 103 * 20);
  EXPECT_GT(server.counters()[Count::kWrongProtocol], 10U);
  EXPECT_GT(server.counters()[Count::kClosedPartialFrame], 10U);
}

}  // namespace
}  // namespace binpick::modbus
