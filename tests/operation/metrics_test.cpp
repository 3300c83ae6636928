// Metrics as text, and what keeps the server from starting. What it answers: metrics_http_test.py.
#include <gmock/gmock.h>

#include <thread>

#include "core/allocation_count.hpp"
#include "metrics/metrics_server.hpp"
#include "setup_error.hpp"
#include "temporary_folder.hpp"

namespace binpick::app {
namespace {

using testing::HasSubstr;

std::string text_of(const MetricRegistry& registry) {
  std::vector<char> memory(registry.text_bytes_max());
  FixedText text(memory);
  registry.write(text);
  EXPECT_TRUE(text.whole());
  return std::string(text.text());
}

TEST(Metrics, AreWrittenAsPrometheusReadsThem) {
  Counter done, failed;
  Gauge bytes;
  MetricRegistry registry;
  registry.add("cycles_total", "Cycles by cause.", done, "cause=\"done\"");
  registry.add("cycles_total", "Cycles by cause.", failed, "cause=\"sensor_lost\"");
  registry.add("memory_bytes", "Resident.", bytes);
  done.add();
  done.add(2);
  registry.set_refresh([&] { bytes.set(4096); });
  EXPECT_EQ(text_of(registry),
            "# HELP cycles_total Cycles by cause.\n"
            "# TYPE cycles_total counter\n"
            "cycles_total{cause=\"done\"} 3\n"
            "cycles_total{cause=\"sensor_lost\"} 0\n"
            "# HELP memory_bytes Resident.\n"
            "# TYPE memory_bytes gauge\n"
            "memory_bytes 4096\n");
}

TEST(Metrics, HistogramsAreCumulativeAndInSeconds) {
  TimeHistogram histogram;
  for (const double ms : {0.5, 1.0, 1.5, 150.0, 20000.0}) histogram.observe(ms);
  histogram.observe(-1);
  histogram.observe(std::numeric_limits<double>::quiet_NaN());
  MetricRegistry registry;
  registry.add("stage_seconds", "Times.", histogram, "stage=\"grab\"");
  const std::string text = text_of(registry);
  EXPECT_THAT(text, HasSubstr("stage_seconds_bucket{stage=\"grab\",le=\"0.001\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("stage_seconds_bucket{stage=\"grab\",le=\"0.1\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("stage_seconds_bucket{stage=\"grab\",le=\"0.2\"} 4\n"));
  EXPECT_THAT(text, HasSubstr("stage_seconds_bucket{stage=\"grab\",le=\"10\"} 4\n"));
  EXPECT_THAT(text, HasSubstr("stage_seconds_bucket{stage=\"grab\",le=\"+Inf\"} 5\n"));
  EXPECT_THAT(text, HasSubstr("stage_seconds_sum{stage=\"grab\"} 20.153000\n"));
  EXPECT_THAT(text, HasSubstr("stage_seconds_count{stage=\"grab\"} 5\n"));
}

TEST(Metrics, TheLargestNumbersHaveRoom) {
  Counter counter;
  Gauge gauge;
  TimeHistogram histogram;
  counter.set(std::numeric_limits<std::uint64_t>::max());
  gauge.set(-std::numeric_limits<double>::max());
  for (int i = 0; i < 1000; ++i) histogram.observe(1e9);
  MetricRegistry registry;
  for (const char* label : {"a=\"1\"", "a=\"2\"", "a=\"3\""})
    registry.add("c", "h", counter, label);
  registry.add("g", "h", gauge);
  registry.add("t", "h", histogram);
  text_of(registry);
}

TEST(MetricsServer, ListensOnThisMachineOnly) {
  Counter counter;
  MetricRegistry registry;
  registry.add("c", "h", counter);
  Arena arena(MetricsServer::footprint(registry) * 8);
  for (const char* listen : {"0.0.0.0:0", "192.168.1.1:80", "[::]:0", "localhost:1", "127.0.0.1",
                             "127.0.0.1:65536", "127.0.0.1:", "127.0.0.1:1x"})
    EXPECT_THROW(MetricsServer({listen}, registry, arena), SetupError) << listen;
}

TEST(MetricsServer, TakesOverASocketThatWasLeftAndNothingElse) {
  const TemporaryFolder folder;
  const std::string path = folder.file("metrics");
  Counter counter;
  MetricRegistry registry;
  registry.add("c", "h", counter);
  Arena arena(MetricsServer::footprint(registry) * 4);
  {
    const MetricsServer first({path}, registry, arena);
    EXPECT_EQ(first.port(), 0);
    const MetricsServer second({path}, registry, arena);
  }
  std::fclose(std::fopen(path.c_str(), "w"));
  EXPECT_THROW(MetricsServer({path}, registry, arena), SetupError);
}

}  // namespace
}  // namespace binpick::app
