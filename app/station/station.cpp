#include "station/station.hpp"

#include <pthread.h>

#include <algorithm>

namespace binpick::app {
namespace {

constexpr std::chrono::milliseconds kIdleWait{250};
// Free running does not hammer on a sensor that is lost.
constexpr std::int64_t kPauseAfterFault_ns = 100'000'000;

int first_recipe(const Config& config) {
  return config.station.recipe != 0 ? config.station.recipe : config.recipes.front().number;
}

}  // namespace

Station::Station(const StationParts& parts, const Config& config, Arena& arena)
    : parts_(parts),
      cycle_({parts.recipes, parts.detector, parts.source, parts.clock,
              [](void* station) { static_cast<Station*>(station)->tell_status(); }, this},
             settings_of(config), config.station.picks_max, first_recipe(config), arena),
      thread_([this] { work(); }) {
  const std::lock_guard lock(mutex_);
  cycle_.set_free_running(config.station.free_run);
  status_ = status_now();
}

Station::~Station() {
  stop();
  thread_.join();
}

void Station::start() {
  {
    const std::lock_guard lock(mutex_);
    started_ = true;
  }
  wake_.notify_all();
}

void Station::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
}

bool Station::offer(const Order& order) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return false;
    std::optional<Order>& slot = order.source == OrderSource::kPlc ? plc_order_ : control_order_;
    if (slot && order.source != OrderSource::kPlc) return false;
    if (slot) {
      ++orders_replaced_;
      plc_order_replaced_one_ = true;
    }
    slot = order;
  }
  wake_.notify_all();
  return true;
}

void Station::set_plc_lost(bool lost) {
  {
    const std::lock_guard lock(mutex_);
    if (plc_lost_ == lost) return;
    plc_lost_ = lost;
  }
  wake_.notify_all();
}

void Station::reload(const Config& config) {
  std::optional<Reload> old;  // freed on this thread, not on the cycle's
  Reload fresh{settings_of(config), config.recipes};
  const std::lock_guard lock(mutex_);
  old = std::exchange(reload_, std::move(fresh));
  reload_fresh_ = true;
}

StationStatus Station::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void Station::work() {
  pthread_setname_np(pthread_self(), "cycle");
  while (const std::optional<Order> order = next_order()) carry_out(*order);
}

std::optional<Order> Station::next_order() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    progress_.fetch_add(1, std::memory_order_relaxed);
    if (plc_lost_ != plc_lost_seen_) {
      plc_lost_seen_ = plc_lost_;
      lock.unlock();
      cycle_.set_plc_lost(plc_lost_seen_);
      tell_status();
      lock.lock();
      continue;
    }
    if (started_) {
      if (std::optional<Order> order = take_order()) return order;
    }
    std::chrono::nanoseconds wait = kIdleWait;
    if (started_ && cycle_.free_running()) {
      const std::chrono::nanoseconds left(free_run_due_ns_ - parts_.clock());
      wait = std::clamp(left, std::chrono::nanoseconds(0), wait);
    }
    wake_.wait_for(lock, wait, [&] {
      return stopping_ || plc_lost_ != plc_lost_seen_ ||
             (started_ && (plc_order_ || control_order_));
    });
  }
  return std::nullopt;
}

// mutex_ is held.
std::optional<Order> Station::take_order() {
  if (plc_order_) {
    order_replaced_one_ = std::exchange(plc_order_replaced_one_, false);
    return std::exchange(plc_order_, std::nullopt);
  }
  if (!control_order_ && !free_run_due()) return std::nullopt;
  order_replaced_one_ = false;
  if (control_order_) return std::exchange(control_order_, std::nullopt);
  Order order;
  order.code = OrderCode::kDetect;
  order.source = OrderSource::kFreeRun;
  order.sequence = ++free_run_sequence_;
  order.received_ns = parts_.clock();
  return order;
}

bool Station::free_run_due() const {
  if (!cycle_.free_running() || parts_.clock() < free_run_due_ns_) return false;
  return !(cycle_.settings().fault_latched && cycle_.state() == StationState::kFault);
}

void Station::carry_out(const Order& order) {
  take_over_reload();
  order_ = order;
  busy_ = true;
  tell_status();
  const CycleResult& result = cycle_.run(order);
  busy_ = false;
  const std::int64_t pause_ns =
      std::max(is_done(result.cause) ? 0 : kPauseAfterFault_ns,
               std::int64_t{1000000} * cycle_.settings().free_run_pause_ms);
  free_run_due_ns_ = parts_.clock() + pause_ns;
  const StationStatus status = keep_status();
  for (StationSink* sink : parts_.sinks) sink->on_result(result, status, cycle_.kept_frame());
}

// Copies values; the strings and lists stay where they are, for the main thread to free.
void Station::take_over_reload() {
  const std::lock_guard lock(mutex_);
  if (!reload_fresh_) return;
  reload_fresh_ = false;
  cycle_.set_settings(reload_->settings);
  parts_.recipes.take_live_values(reload_->recipes);
}

StationStatus Station::status_now() const {
  return {cycle_.state(), cycle_.selected_recipe(), cycle_.free_running(), plc_lost_seen_, order_,
          busy_,          order_replaced_one_,      orders_replaced_};
}

StationStatus Station::keep_status() {
  const std::lock_guard lock(mutex_);
  status_ = status_now();
  return status_;
}

void Station::tell_status() {
  progress_.fetch_add(1, std::memory_order_relaxed);
  const StationStatus status = keep_status();
  for (StationSink* sink : parts_.sinks) sink->on_status(status);
}

}  // namespace binpick::app
