// The station's metrics: counts answers on the cycle's thread, and fetches what the other parts
// count when somebody asks. Thread: on_result() the cycle's; the rest as the metrics server's.
#pragma once

#include <array>

#include "daemon/modbus_link.hpp"
#include "daemon/recorder_sink.hpp"
#include "log/log.hpp"
#include "metrics/metrics.hpp"

namespace binpick::app {

// What the system refused at start, and the station goes on without.
struct RefusedSettings {
  bool lock = false, scheduling = false;
};

// What is looked at; null: there is none. They outlive the sink.
struct MetricsSources {
  const SensorSession* session = nullptr;
  const ModbusLink* link = nullptr;
  RecorderSink* recorder = nullptr;
  const Log* log = nullptr;
  RefusedSettings refused;
};

class MetricsSink final : public StationSink {
 public:
  MetricsSink();
  // Before the registry is asked for the first time.
  void watch(const MetricsSources& sources);

  void on_status(const StationStatus& status) override;
  void on_result(const CycleResult& result, const StationStatus& status,
                 const FrameRef& kept_frame) override;
  const MetricRegistry& registry() const { return registry_; }

 private:
  static constexpr int kTimes = 5;
  static constexpr std::size_t kCauses = std::size(modbus::map::kCauseNames);

  void refresh();
  void refresh_sensor();
  void refresh_recorder();
  void refresh_process();
  void add_sensor();
  void add_modbus();
  void add_rest();

  MetricsSources sources_;
  MetricRegistry registry_;
  std::array<Counter, kCauses> answers_;
  std::array<TimeHistogram, kTimes> times_;
  Counter picks_, detections_, late_;
  Counter commands_replaced_;
  Gauge state_, recipe_;
  Gauge lock_refused_, scheduling_refused_;
  Gauge sensor_ready_;
  Counter sensor_opened_, sensor_losses_, sensor_frames_;
  std::array<Counter, drivers::kDropReasonCount> sensor_dropped_;
  Gauge modbus_clients_;
  std::array<Counter, modbus::kCountNumber> modbus_counts_;
  Counter recorded_, written_, overwritten_, write_failed_, removed_;
  Gauge recordings_bytes_;
  Counter log_lines_, log_dropped_, log_suppressed_;
  Gauge resident_bytes_, locked_bytes_, threads_;
};

}  // namespace binpick::app
