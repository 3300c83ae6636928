// What clients see while the station publishes at full speed, and while other clients misbehave.
// Times are printed; what is asserted is far above what a quiet machine shows.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <random>
#include <thread>

#include "clock.hpp"
#include "command_inbox.hpp"
#include "fake_answers.hpp"
#include "hostile_clients.hpp"
#include "modbus/server.hpp"
#include "raw_client.hpp"

namespace binpick::modbus {
namespace {

constexpr double kRoundTripMsMax = 500;  // p99.9, on a machine that others use too

ServerConfig loopback_config() {
  ServerConfig config;
  config.bind_address = "127.0.0.1";
  config.port = 0;
  config.clients_max = 32;
  config.frame_timeout_ms = 300;
  return config;
}

// Publishes fake answers as fast as it can, or at a pace.
class Publisher {
 public:
  Publisher(AnswerImage& image, int pause_us)
      : thread_([this, &image, pause_us] {
          AnswerRegisters registers;
          for (std::uint32_t n = 1; !stopping_; ++n) {
            encode_answer(fake_answer(n), {}, registers);
            image.publish(registers, app::monotonic_ns());
            published_ = n;
            if (pause_us > 0) std::this_thread::sleep_for(std::chrono::microseconds(pause_us));
          }
        }) {}
  ~Publisher() {
    stopping_ = true;
    thread_.join();
  }
  std::uint32_t published() const { return published_; }

 private:
  std::atomic<bool> stopping_{false};
  std::atomic<std::uint32_t> published_{0};
  std::thread thread_;
};

struct Watched {
  int reads = 0;
  int torn = 0;
  int backwards = 0;
  std::vector<double> round_trips_ms;
};

// Reads whole answers, each after a pause of 0 to `pause_us_max`.
Watched watch(int port, int function, int pause_us_max, double seconds) {
  RawClient client(port);
  std::mt19937 random(static_cast<unsigned>(function));
  Watched watched;
  std::uint32_t last = 0;
  const std::int64_t end_ns = app::monotonic_ns() + static_cast<std::int64_t>(seconds * 1e9);
  while (app::monotonic_ns() < end_ns) {
    AnswerRegisters registers;
    const std::int64_t before_ns = app::monotonic_ns();
    if (!client.read_answer(registers, function)) {
      ADD_FAILURE() << "no answer, after " << watched.reads << " reads";
      break;
    }
    watched.round_trips_ms.push_back(static_cast<double>(app::monotonic_ns() - before_ns) * 1e-6);
    ++watched.reads;
    const auto decoded = decode_answer(registers);
    const bool nothing_yet = decoded && decoded->answer.result_sequence == 0;
    if (!nothing_yet && !is_whole(registers, {})) ++watched.torn;
    if (decoded && decoded->answer.cycle_number < last) ++watched.backwards;
    if (decoded) last = decoded->answer.cycle_number;
    if (pause_us_max > 0) {
      std::this_thread::sleep_for(std::chrono::microseconds(random() % pause_us_max));
    }
  }
  return watched;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

void print(const char* name, const Watched& watched) {
  std::printf("%s: %d reads, round trip p50 %.3f, p99 %.3f, p99.9 %.3f, max %.3f ms\n", name,
              watched.reads, quantile(watched.round_trips_ms, 0.5),
              quantile(watched.round_trips_ms, 0.99), quantile(watched.round_trips_ms, 0.999),
              quantile(watched.round_trips_ms, 1));
}

TEST(Load, NoReadIsTornWhilePublishingAtFullSpeed) {
  AnswerImage image;
  CommandInbox inbox;
  Server server(loopback_config(), {}, image, inbox);
  server.start();
  const Publisher publisher(image, 0);
  Watched by_input;
  std::thread other([&] { by_input = watch(server.port(), 4, 700, 2.0); });
  const Watched by_holding = watch(server.port(), 3, 0, 2.0);
  other.join();
  for (const Watched& watched : {by_holding, by_input}) {
    EXPECT_GT(watched.reads, 50);
    EXPECT_EQ(watched.torn, 0);
    EXPECT_EQ(watched.backwards, 0);
  }
  std::printf("%u answers published, %d + %d reads, none torn\n", publisher.published(),
              by_holding.reads, by_input.reads);
}

TEST(Load, AWellBehavedClientIsServedWhileOthersMisbehave) {
  AnswerImage image;
  CommandInbox inbox;
  Server server(loopback_config(), {}, image, inbox);
  server.start();
  const Publisher publisher(image, 1000);
  const Watched quiet = watch(server.port(), 3, 4000, 2.0);
  Watched loud;
  {
    const HostileClients hostile(server.port());
    loud = watch(server.port(), 3, 4000, 5.0);
  }
  EXPECT_GT(loud.reads, 50);
  EXPECT_EQ(loud.torn, 0);
  EXPECT_LT(quantile(loud.round_trips_ms, 0.999), kRoundTripMsMax);
  print("alone", quiet);
  print("among hostile clients", loud);
  for (std::size_t i = 0; i < kCountNumber; ++i) {
    std::printf("%s %llu\n", count_name(static_cast<Count>(i)),
                static_cast<unsigned long long>(server.counters()[static_cast<Count>(i)]));
  }
  EXPECT_GT(server.counters()[Count::kWrongProtocol], 0U);
  EXPECT_GT(server.counters()[Count::kClosedPartialFrame], 0U);
}

}  // namespace
}  // namespace binpick::modbus
