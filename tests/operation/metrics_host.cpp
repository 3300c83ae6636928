// A metrics server alone, for metrics_http_test.py: prints its port, and ends with its input. A
// byte of input counts a cycle. Exit status 1: it took from the heap while it answered.
#include <unistd.h>

#include <cstdio>

#include "core/allocation_count.hpp"
#include "metrics/metrics_server.hpp"

int main(int argc, char** argv) {
  using namespace binpick;
  using namespace binpick::app;
  Counter cycles;
  TimeHistogram detect;
  MetricRegistry registry;
  registry.add("binpick_cycles_total", "Cycles.", cycles, "cause=\"done\"");
  registry.add("binpick_stage_seconds", "Times.", detect, "stage=\"detect\"");
  Arena arena(MetricsServer::footprint(registry));
  const MetricsServer server({argc > 1 ? argv[1] : "127.0.0.1:0", 1000}, registry, arena);
  arena.seal();
  std::printf("%d\n", server.port());
  std::fflush(stdout);
  const long long before = allocation_count();
  char byte;
  while (read(STDIN_FILENO, &byte, 1) == 1) {
    cycles.add();
    detect.observe(120);
  }
  return allocation_count() == before ? 0 : 1;
}
