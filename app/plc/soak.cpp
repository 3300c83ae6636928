#include "plc/soak.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>
#include <thread>

namespace binpick::plc {
namespace {

namespace map = modbus::map;
using map::CommandCode;

// Enough for quantiles; later ones replace earlier ones, so that a run of days does not grow.
constexpr std::size_t kSamplesKept = 100'000;

void keep(std::vector<double>& samples, long long number, double value) {
  if (samples.size() < kSamplesKept) {
    samples.push_back(value);
  } else {
    samples[static_cast<std::size_t>(number) % kSamplesKept] = value;
  }
}

// Mostly whole cycles; now and then the robot moves in between, or wants further pages.
CommandCode next_code(const modbus::AnswerSnapshot& before, CommandCode last, unsigned dice) {
  if (last == CommandCode::kCapture) return CommandCode::kProcess;
  const bool more_pages = before.page > 0 && before.page < modbus::page_count(before.picks);
  if (more_pages && dice % 2 == 0) return CommandCode::kNextPage;
  return dice % 10 == 1 ? CommandCode::kCapture : CommandCode::kDetect;
}

void print_times(const char* name, std::vector<double> values) {
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  const auto at = [&](double q) {
    return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
  };
  std::printf("%-44s p50 %8.3f  p99 %8.3f  p99.9 %8.3f  max %8.3f\n", name, at(0.5), at(0.99),
              at(0.999), values.back());
}

}  // namespace

SoakReport soak(PlcSession& session, const SoakOptions& options) {
  SoakReport report;
  std::mt19937_64 random(options.seed);
  const auto pause = [&] {
    const auto us = static_cast<std::int64_t>(random() % (2000U * options.poll_ms + 1));
    std::this_thread::sleep_for(std::chrono::microseconds(us));
  };
  const auto count_read = [&](const PlcSession::Seen& seen) {
    const double ms = static_cast<double>(seen.ended_ns - seen.begun_ns) * 1e-6;
    keep(report.round_trips_ms, report.reads++, ms);
  };
  modbus::AnswerSnapshot before = session.first().decoded.answer;
  CommandCode code = CommandCode::kNone;
  for (; report.cycles < options.cycles; ++report.cycles) {
    modbus::Command command = options.command;
    command.code = code = next_code(before, code, static_cast<unsigned>(random() >> 33U));
    session.send(command);
    const auto seen = session.wait_for_answer(options.timeout_ms, pause, count_read);
    if (!seen) {
      ++report.unanswered;
      continue;
    }
    before = seen->decoded.answer;
    const double took_ms = static_cast<double>(seen->ended_ns - session.sent_ns()) * 1e-6;
    keep(report.overheads_ms, report.cycles, took_ms - static_cast<double>(before.cycle_time_ms));
    report.refused += static_cast<int>(before.cause) >= 100 ? 1 : 0;
    report.empty += before.picks == 0 ? 1 : 0;
    // The result stays as it is until the next command: looked at again, some time later.
    for (auto reads = random() % 4; reads > 0; --reads) {
      pause();
      session.beat();
      if (const auto again = session.read()) count_read(*again);
    }
  }
  report.faults = session.invariants().fault_count();
  return report;
}

void print(const SoakReport& report, const Invariants& invariants) {
  std::printf(
      "%lld cycles, %lld reads; %lld without a pick, %lld refused or failed, %lld "
      "unanswered\n",
      report.cycles, report.reads, report.empty, report.refused, report.unanswered);
  print_times("round trip of a read [ms]", report.round_trips_ms);
  print_times("command to answer, less cycle_time [ms]", report.overheads_ms);
  for (const std::string& fault : invariants.faults()) std::printf("broken: %s\n", fault.c_str());
  std::printf("%lld invariants broken\n", report.faults);
}

bool passed(const SoakReport& report) {
  return report.faults == 0 && report.unanswered == 0 && report.refused == 0;
}

}  // namespace binpick::plc
