#include "daemon/daemon.hpp"

#include <algorithm>
#include <cstring>

#include "clock.hpp"
#include "config/config_file.hpp"
#include "daemon/thread_setup.hpp"
#include "frame_findings.hpp"
#include "sensor/sensor_spec.hpp"
#include "setup_error.hpp"

namespace binpick::app {
namespace {

constexpr int kTurn_ms = 250;

MemoryPlan checked_plan(const Config& config, const RecipeSet& recipes) {
  MemoryPlan plan = make_memory_plan(config, recipes);
  check_memory_plan(plan, config.memory);
  return plan;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

Daemon::Daemon(const Config& config, OpenFn open, Log& log, Notifier& notifier)
    : config_(config),
      log_(log),
      notifier_(notifier),
      recipes_(config_),
      plan_(checked_plan(config_, recipes_)),
      arena_(lock_memory_first()),
      frames_(frame_pool_params(config_), arena_),
      workers_(make_workers()),
      detector_(recipes_.models(), recipes_.limits(), {MapLayout::kRearranged, config_.threads.isa},
                workers_, monotonic_ns, arena_),
      board_(config_.station.picks_max, arena_),
      sink_count_(collect_sinks()),
      session_(std::move(open), frames_,
               with_port_reset(config_.sensor.uri, session_params_of(config_.sensor))),
      arrivals_(config_.sensor.uri, session_),
      source_(session_),
      station_(make_station()),
      control_(config_.station.control_socket,
               {[this](const Order& order) { return station_.offer(order); },
                [this] { return status_text(); }, [this] { return record(); }}) {
  metrics_.watch({&session_, modbus_ ? &*modbus_ : nullptr, recorder_ ? &*recorder_ : nullptr,
                  &log_, refused_});
  if (!config_.metrics.listen.empty())
    metrics_server_.emplace(MetricsServerParams{config_.metrics.listen}, metrics_.registry(),
                            arena_);
  // What was planned is what was taken.
  BINPICK_ASSERT(arena_.used_bytes() == plan_.arena_bytes());
  arena_.seal();
}

// Before the arena is made, which then has its pages at once and for good.
std::size_t Daemon::lock_memory_first() {
  const std::string refused = lock_memory(plan_, config_.memory);
  refused_.lock = !refused.empty();
  if (refused_.lock) log_.warning("%s: goes on without locked memory", refused.c_str());
  return plan_.arena_bytes();
}

// Once, not once a thread.
void Daemon::tell_refused(const std::string& refused) {
  if (refused.empty() || refused_.scheduling) return;
  refused_.scheduling = true;
  log_.warning("%s: goes on without", refused.c_str());
}

ThreadPool Daemon::make_workers() {
  const ScopedScheduling scheduling(config_.threads);
  tell_refused(scheduling.refused());
  return ThreadPool(worker_count(config_));
}

Station Daemon::make_station() {
  const ScopedScheduling scheduling(config_.threads);
  tell_refused(scheduling.refused());
  return Station({recipes_, detector_, source_, monotonic_ns, std::span(sinks_).first(sink_count_)},
                 config_, arena_);
}

// Modbus first: nobody there waits for the others. The board last: when it says that there is
// something new, it is everywhere.
std::size_t Daemon::collect_sinks() {
  std::size_t count = 0;
  if (config_.modbus.enabled) sinks_[count++] = &modbus_.emplace(config_);
  sinks_[count++] = &metrics_;
  if (!config_.recorder.folder.empty())
    sinks_[count++] = &recorder_.emplace(config_, recipes_, modbus_ ? &*modbus_ : nullptr, arena_);
  sinks_[count++] = &board_;
  return count;
}

void Daemon::run() {
  station_.start();
  if (modbus_) modbus_->start(station_, session_);
  log_.info("ready: %zu recipes, %.0f MiB planned, %d threads compute", recipes_.recipes().size(),
            static_cast<double>(plan_.bytes_total()) / (1 << 20), workers_.thread_count());
  if (modbus_) log_.info("Modbus TCP on %s:%d", config_.modbus.bind.c_str(), modbus_->port());
  notifier_.ready("waiting for commands");
  int wait_ms = kTurn_ms;
  if (const auto period = notifier_.watchdog_period())
    wait_ms = std::clamp(static_cast<int>(period->count() / 4000), 1, kTurn_ms);
  while (!ending_) turn(wait_ms);
  notifier_.stopping();
  log_.info("stopping");
  // No new orders; the cycle that runs is answered.
  if (modbus_) modbus_->stop();
  station_.stop();
}

void Daemon::turn(int wait_ms) {
  std::array<pollfd, 2 + ControlSocket::kDescriptorsMax> descriptors = {
      {{signals_.descriptor(), POLLIN, 0}, {board_.descriptor(), POLLIN, 0}}};
  const std::size_t of_control = control_.put_descriptors(std::span(descriptors).subspan<2>());
  poll(descriptors.data(), 2 + of_control, wait_ms);
  if (descriptors[1].revents != 0) tell_answers();
  control_.handle(std::span(descriptors).subspan(2, of_control));
  handle_signals();
  tell_sensor();
  tell_recorder();
  tell_replaced();
  tell_refused_clients();
  feed_watchdog();
}

void Daemon::handle_signals() {
  while (const int signal = signals_.take()) {
    if (signal == SIGHUP) {
      reload();
    } else {
      ending_ = true;
    }
  }
}

void Daemon::reload() {
  notifier_.reloading();
  try {
    const Config wanted = load_config(config_.file);
    const ReloadLimits limits = recipes_.reload_limits();
    const ConfigChanges changes = compare(config_, wanted, limits);
    take_live_values(config_, wanted, limits);
    station_.reload(config_);
    if (modbus_) modbus_->set_flange_needed(needs_flange_pose(config_.station));
    log_.set_level(config_.logging.level);
    if (recorder_) recorder_->reload(config_, recipes_);
    if (changes.live.empty() && changes.restart.empty()) log_.info("reload: nothing has changed");
    if (!changes.live.empty()) log_.info("reload: taken over: %s", joined(changes.live).c_str());
    if (!changes.restart.empty())
      log_.warning("reload: needs a restart: %s", joined(changes.restart).c_str());
  } catch (const std::exception& e) {
    log_.error("reload: nothing is changed: %s", e.what());
  }
  notifier_.ready("waiting for commands");
}

void Daemon::tell_answers() {
  board_.clear_event();
  for (int i = 0; i < ResultBoard::kSources; ++i) {
    const auto source = static_cast<OrderSource>(i);
    const ResultBoard::Brief last = board_.brief(source);
    if (last.number == told_[static_cast<std::size_t>(i)]) continue;
    told_[static_cast<std::size_t>(i)] = last.number;
    const CycleResult& r = last.result;
    tell_findings(r);
    if (source == OrderSource::kControl) control_.answer(board_.last(source).result);
    std::array<char, 160> memory;
    FixedText error(memory);
    if (r.error.code != ErrorCode::kNone) write_error(r.error, error);
    if (is_fault(r.cause)) {
      log_.about_cycle(LogLevel::kWarning, r.cycle, cause_name(r.cause), "cycle %llu: %s: %s%s%.*s",
                       static_cast<unsigned long long>(r.cycle), order_name(r.order.code),
                       cause_name(r.cause), error.length() > 0 ? ": " : "",
                       static_cast<int>(error.length()), error.text().data());
    } else {
      log_.about_cycle(LogLevel::kDebug, r.cycle, cause_name(r.cause),
                       "cycle %llu: %s: %s, %zu picks of %d, grab %.1f detect %.1f total %.1f ms",
                       static_cast<unsigned long long>(r.cycle), order_name(r.order.code),
                       cause_name(r.cause), last.pick_count, r.detections, r.times.grab_ms,
                       r.times.detect_ms, r.times.total_ms);
    }
  }
}

// Once a change, not once a cycle.
void Daemon::tell_findings(const CycleResult& r) {
  if (r.order.code != OrderCode::kDetect && r.order.code != OrderCode::kProcess) return;
  std::uint32_t found = 0;
  for (const Finding& finding : r.findings.found()) {
    const std::uint32_t bit = std::uint32_t{1} << static_cast<int>(finding.code);
    const bool told = ((found | findings_told_) & bit) != 0;
    found |= bit;
    if (told) continue;
    std::array<char, LogLine::kTextBytes> memory;
    FixedText text(memory);
    const auto model = static_cast<std::size_t>(finding.model);
    write_finding(finding, finding.model < 0 ? "" : recipes_.files()[model]->name().c_str(), text);
    text.add("; ");
    write_advice(finding, text);
    log_.about_cycle(LogLevel::kWarning, r.cycle, cause_name(r.cause), "cycle %llu: frame: %.*s",
                     static_cast<unsigned long long>(r.cycle), static_cast<int>(text.length()),
                     text.text().data());
  }
  findings_told_ = found;
}

// Once a change, not once a look.
void Daemon::tell_sensor() {
  const SessionCounts status = session_.counts();
  if (status.losses != losses_told_) {
    losses_told_ = status.losses;
    log_.warning("%s: lost (%llu times since start)", config_.sensor.uri.c_str(),
                 static_cast<unsigned long long>(status.losses));
  }
  if (status.opened != opened_told_) {
    opened_told_ = status.opened;
    open_error_told_.clear();
    log_.info("%s: open", config_.sensor.uri.c_str());
  }
  if (status.open_failures == open_failures_told_) return;
  open_failures_told_ = status.open_failures;
  const std::string error = session_.status().last_error;
  if (status.state == SessionState::kReady || error == open_error_told_) return;
  open_error_told_ = error;
  log_.warning("%s", error.c_str());
}

// False: there is no recorder.
bool Daemon::record() {
  if (recorder_) recorder_->recorder().write_kept();
  return recorder_.has_value();
}

void Daemon::tell_recorder() {
  if (!recorder_) return;
  const RecorderCounters c = recorder_->recorder().counters();
  const std::uint64_t lost = c.overwritten + c.write_failed + c.frame_too_large;
  if (lost == records_lost_told_) return;
  log_.warning("recorder: %llu cycles could not be recorded: %s",
               static_cast<unsigned long long>(lost - records_lost_told_),
               c.last_errno != 0 ? std::strerror(c.last_errno) : "the disk is too slow");
  records_lost_told_ = lost;
}

void Daemon::tell_refused_clients() {
  if (!modbus_) return;
  const std::uint64_t refused = modbus_->server().counters()[modbus::Count::kRefusedLimit];
  if (refused == refused_clients_told_) return;
  log_.warning("Modbus: %llu clients refused: all %d places of modbus.clients_max are taken",
               static_cast<unsigned long long>(refused - refused_clients_told_),
               config_.modbus.clients_max);
  refused_clients_told_ = refused;
}

void Daemon::tell_replaced() {
  const std::uint64_t replaced = station_.status().orders_replaced;
  if (replaced == replaced_told_) return;
  log_.warning("%llu commands of the PLC were replaced by newer ones before their turn came",
               static_cast<unsigned long long>(replaced - replaced_told_));
  replaced_told_ = replaced;
}

// By the cycle's own steps: a cycle that hangs is not fed, however lively this loop is.
void Daemon::feed_watchdog() {
  const std::uint64_t progress = station_.progress();
  if (progress == progress_fed_) return;
  progress_fed_ = progress;
  if (notifier_.watchdog_period()) notifier_.watchdog();
}

std::string Daemon::status_text() const {
  ResultBoard::Copy newest;
  for (int i = 0; i < ResultBoard::kSources; ++i) {
    ResultBoard::Copy last = board_.last(static_cast<OrderSource>(i));
    if (last.result.cycle > newest.result.cycle) newest = std::move(last);
  }
  return status_json(station_.status(), session_state_name(session_.status().state), newest.result);
}

}  // namespace binpick::app
