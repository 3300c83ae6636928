#include "daemon/metrics_sink.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace binpick::app {
namespace {

namespace map = modbus::map;

constexpr const char* kTimeNames[] = {"wait", "grab", "detect", "rank", "total"};

std::string label(const char* name, const char* value) {
  return std::string(name) + "=\"" + value + "\"";
}

// The number behind `name` in /proc/self/status; 0: it is not there.
double status_number(const char* text, const char* name) {
  const char* line = std::strstr(text, name);
  return line == nullptr ? 0 : std::strtod(line + std::strlen(name), nullptr);
}

}  // namespace

MetricsSink::MetricsSink() {
  for (std::size_t i = 0; i < kCauses; ++i)
    registry_.add("binpick_answers_total", "Answers by cause.", answers_[i],
                  label("cause", map::kCauseNames[i].name));
  for (std::size_t i = 0; i < times_.size(); ++i)
    registry_.add("binpick_cycle_seconds", "Times of cycles that were done, by stage.", times_[i],
                  label("stage", kTimeNames[i]));
  registry_.add("binpick_picks_total", "Picks published.", picks_);
  registry_.add("binpick_detections_total", "Parts found, picked or not.", detections_);
  registry_.add("binpick_late_answers_total", "Answers after their deadline.", late_);
  registry_.add("binpick_state", "0 idle, 1 grabbing, 2 computing, 3 done, 4 fault.", state_);
  registry_.add("binpick_recipe", "The recipe that is selected.", recipe_);
  registry_.add("binpick_commands_replaced_total",
                "Commands of the PLC that a newer one replaced before their turn came.",
                commands_replaced_);
  add_sensor();
  add_modbus();
  add_rest();
  registry_.set_refresh([this] { refresh(); });
}

void MetricsSink::watch(const MetricsSources& sources) {
  sources_ = sources;
  lock_refused_.set(sources.refused.lock ? 1 : 0);
  scheduling_refused_.set(sources.refused.scheduling ? 1 : 0);
}

void MetricsSink::add_sensor() {
  registry_.add("binpick_sensor_ready", "1: the sensor is open.", sensor_ready_);
  registry_.add("binpick_sensor_opened_total", "Connections made.", sensor_opened_);
  registry_.add("binpick_sensor_losses_total", "Connections lost.", sensor_losses_);
  registry_.add("binpick_sensor_frames_total", "Frames taken.", sensor_frames_);
  for (int i = 1; i < drivers::kDropReasonCount; ++i)
    registry_.add("binpick_sensor_dropped_total", "Frames that were not used, by reason.",
                  sensor_dropped_[static_cast<std::size_t>(i)],
                  label("reason", drivers::drop_reason_name(static_cast<drivers::DropReason>(i))));
}

void MetricsSink::add_modbus() {
  registry_.add("binpick_modbus_clients", "Modbus clients connected.", modbus_clients_);
  for (std::size_t i = 0; i < modbus_counts_.size(); ++i)
    registry_.add("binpick_modbus_events_total", "What the Modbus server has seen.",
                  modbus_counts_[i],
                  label("event", modbus::count_name(static_cast<modbus::Count>(i))));
}

void MetricsSink::add_rest() {
  registry_.add("binpick_recorder_kept_total", "Cycles taken into memory.", recorded_);
  registry_.add("binpick_recorder_written_total", "Cycles written to the disk.", written_);
  registry_.add("binpick_recorder_overwritten_total", "Cycles lost: the disk is too slow.",
                overwritten_);
  registry_.add("binpick_recorder_failed_total", "Cycles lost: the disk is full or fails.",
                write_failed_);
  registry_.add("binpick_recordings_removed_total", "Old recordings that made room.", removed_);
  registry_.add("binpick_recordings_bytes", "Disk space of all recordings.", recordings_bytes_);
  registry_.add("binpick_log_lines_total", "Log lines written.", log_lines_);
  registry_.add("binpick_log_dropped_total", "Log lines lost: the journal is too slow.",
                log_dropped_);
  registry_.add("binpick_log_suppressed_total", "Log lines left out: said too often.",
                log_suppressed_);
  registry_.add("binpick_resident_bytes", "Resident memory.", resident_bytes_);
  registry_.add("binpick_locked_bytes", "Locked memory.", locked_bytes_);
  constexpr const char* kRefused = "1: the system refused it at start.";
  registry_.add("binpick_setting_refused", kRefused, lock_refused_,
                label("setting", "memory.lock"));
  registry_.add("binpick_setting_refused", kRefused, scheduling_refused_,
                label("setting", "threads"));
  registry_.add("binpick_threads", "Threads, those of libraries too.", threads_);
}

void MetricsSink::on_status(const StationStatus& status) {
  state_.set(static_cast<double>(status.state));
  recipe_.set(status.recipe);
  commands_replaced_.set(status.orders_replaced);
}

void MetricsSink::on_result(const CycleResult& result, const StationStatus& status,
                            const FrameRef&) {
  on_status(status);
  for (std::size_t i = 0; i < kCauses; ++i) {
    if (map::kCauseNames[i].value == static_cast<std::uint16_t>(result.cause)) answers_[i].add();
  }
  const OrderCode code = result.order.code;
  const bool cycle = code == OrderCode::kDetect || code == OrderCode::kProcess;
  if (!cycle || !is_done(result.cause)) return;
  picks_.add(result.picks.size());
  detections_.add(static_cast<std::uint64_t>(result.detections));
  if (result.late) late_.add();
  const CycleTimes& t = result.times;
  const double ms[] = {t.wait_ms, t.grab_ms, t.detect_ms, t.rank_ms, t.total_ms};
  for (std::size_t i = 0; i < times_.size(); ++i) times_[i].observe(ms[i]);
}

void MetricsSink::refresh() {
  if (sources_.session != nullptr) refresh_sensor();
  if (sources_.link != nullptr) {
    const modbus::Server& server = sources_.link->server();
    modbus_clients_.set(server.client_count());
    for (std::size_t i = 0; i < modbus_counts_.size(); ++i)
      modbus_counts_[i].set(server.counters()[static_cast<modbus::Count>(i)]);
  }
  if (sources_.recorder != nullptr) refresh_recorder();
  if (sources_.log != nullptr) {
    const LogCounters counters = sources_.log->counters();
    log_lines_.set(counters.written);
    log_dropped_.set(counters.dropped);
    log_suppressed_.set(counters.suppressed);
  }
  refresh_process();
}

void MetricsSink::refresh_sensor() {
  const SessionCounts status = sources_.session->counts();
  sensor_ready_.set(status.state == SessionState::kReady ? 1 : 0);
  sensor_opened_.set(status.opened);
  sensor_losses_.set(status.losses);
  sensor_frames_.set(status.camera.frames);
  for (std::size_t i = 0; i < sensor_dropped_.size(); ++i)
    sensor_dropped_[i].set(status.camera.dropped[i]);
}

void MetricsSink::refresh_recorder() {
  const RecorderCounters c = sources_.recorder->recorder().counters();
  recorded_.set(c.recorded);
  written_.set(c.written);
  overwritten_.set(c.overwritten);
  write_failed_.set(c.write_failed);
  removed_.set(c.recordings_removed);
  recordings_bytes_.set(static_cast<double>(c.disk_bytes));
}

void MetricsSink::refresh_process() {
  const int fd = open("/proc/self/status", O_RDONLY | O_CLOEXEC);
  if (fd < 0) return;
  char text[4096];
  const ssize_t bytes = read(fd, text, sizeof text - 1);
  close(fd);
  text[bytes > 0 ? bytes : 0] = '\0';
  constexpr double kKiB = 1024;
  resident_bytes_.set(status_number(text, "VmRSS:") * kKiB);
  locked_bytes_.set(status_number(text, "VmLck:") * kKiB);
  threads_.set(status_number(text, "Threads:"));
}

}  // namespace binpick::app
