// The station as a whole: every part a member, in the order in which they start; they end in
// reverse. run() is the main thread's loop: signals, the control socket, the log of answers, the
// service manager.
#pragma once

#include <array>
#include <cstdint>

#include "daemon/control_socket.hpp"
#include "daemon/metrics_sink.hpp"
#include "daemon/modbus_link.hpp"
#include "daemon/notify.hpp"
#include "daemon/recorder_sink.hpp"
#include "daemon/result_board.hpp"
#include "daemon/signals.hpp"
#include "memory_plan.hpp"
#include "metrics/metrics_server.hpp"
#include "sensor/live_sensor.hpp"
#include "sensor/session_source.hpp"
#include "thread_pool.hpp"

namespace binpick::app {

class Daemon {
 public:
  using OpenFn = SensorSession::OpenFn;

  // `open` opens the sensor: open_camera with the configuration's spec, or a test's. Throws
  // SetupError and what reading files throws. Signals of SignalInbox must be blocked by then.
  Daemon(const Config& config, OpenFn open, Log& log, Notifier& notifier);
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  // Until a signal asks it to end, or stop() (any thread).
  void run();

  Station& station() { return station_; }
  const SensorSession& session() const { return session_; }
  const MemoryPlan& plan() const { return plan_; }
  const Arena& arena() const { return arena_; }
  // Of the Modbus server; 0: there is none.
  int modbus_port() const { return modbus_ ? modbus_->port() : 0; }
  void stop() { ending_ = true; }

 private:
  void turn(int wait_ms);
  void handle_signals();
  void reload();
  void tell_answers();
  void tell_findings(const CycleResult& result);
  void tell_sensor();
  void feed_watchdog();
  std::string status_text() const;
  bool record();
  void tell_recorder();
  void tell_replaced();
  void tell_refused_clients();
  std::size_t lock_memory_first();
  void tell_refused(const std::string& refused);
  ThreadPool make_workers();
  Station make_station();
  std::size_t collect_sinks();

  Config config_;
  Log& log_;
  Notifier& notifier_;
  RecipeSet recipes_;
  MemoryPlan plan_;
  RefusedSettings refused_;
  Arena arena_;
  FramePool frames_;
  ThreadPool workers_;
  Detector detector_;
  ResultBoard board_;
  std::optional<ModbusLink> modbus_;  // none where it is not enabled
  MetricsSink metrics_;
  std::optional<RecorderSink> recorder_;  // none where no folder is configured
  std::array<StationSink*, 4> sinks_;
  std::size_t sink_count_ = 0;
  SensorSession session_;
  ArrivalWatch arrivals_;
  SessionSource source_;
  Station station_;
  std::optional<MetricsServer> metrics_server_;
  ControlSocket control_;
  SignalInbox signals_;

  std::atomic<bool> ending_{false};
  std::array<std::uint64_t, ResultBoard::kSources> told_{};
  std::uint32_t findings_told_ = 0;  // bit: FindingCode
  std::uint64_t progress_fed_ = 0, opened_told_ = 0, losses_told_ = 0, open_failures_told_ = 0;
  std::string open_error_told_;
  std::uint64_t records_lost_told_ = 0, replaced_told_ = 0, refused_clients_told_ = 0;
};

}  // namespace binpick::app
