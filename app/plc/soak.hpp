// Many handshakes with a jitter of the polling, in which every invariant is checked.
#pragma once

#include "modbus/command.hpp"
#include "plc/plc_session.hpp"

namespace binpick::plc {

struct SoakOptions {
  long long cycles = 0;
  int poll_ms = 20;  // pauses between reads are 0 to twice this
  int timeout_ms = 5000;
  std::uint64_t seed = 1;
  modbus::Command command;  // recipe, limits and flange pose of the cycles
};

struct SoakReport {
  long long cycles = 0;
  long long reads = 0;
  long long unanswered = 0;
  long long empty = 0;    // answers without a pick
  long long refused = 0;  // causes from 100 on
  long long faults = 0;   // broken invariants
  std::vector<double> round_trips_ms;
  std::vector<double> overheads_ms;  // command written to answer read, less cycle_time
};

// Throws app::SetupError when the connection is lost.
SoakReport soak(PlcSession& session, const SoakOptions& options);
void print(const SoakReport& report, const Invariants& invariants);
bool passed(const SoakReport& report);

}  // namespace binpick::plc
