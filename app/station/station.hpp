// The cycle's thread: takes orders from the PLC, from the control socket and from itself (free
// running), has them carried out one after the other and hands each answer to the sinks. Every
// order that is taken gets exactly one answer. Of the PLC's orders that arrive during a cycle the
// newest is taken when it ends; the others are never taken, counted, and the one that took their
// place says so. Allocates nothing after construction. Thread-safe.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "station/cycle.hpp"

namespace binpick::app {

// As it is now.
struct StationStatus {
  StationState state = StationState::kIdle;
  int recipe = 0;  // selected
  bool free_running = false;
  bool plc_lost = false;
  // The last order that was taken, and whether it is still being carried out.
  Order order;
  bool busy = false;
  // Of the PLC: the last order took the place of others that waited, and how often that happened.
  bool order_replaced_one = false;
  std::uint64_t orders_replaced = 0;
};

// Who gets the answers. Called on the cycle's thread: must neither block nor allocate.
class StationSink {
 public:
  virtual ~StationSink() = default;
  // An order was taken, or it went on to another state.
  virtual void on_status(const StationStatus& status) = 0;
  // `result` is borrowed for the call, kept_frame too (empty when there is none).
  virtual void on_result(const CycleResult& result, const StationStatus& status,
                         const FrameRef& kept_frame) = 0;
};

struct StationParts {
  RecipeSet& recipes;
  Detector& detector;
  FrameSource& source;
  ClockFn clock;
  std::span<StationSink* const> sinks;  // outlive the station, the span too
};

class Station {
 public:
  static std::size_t footprint(int picks_max) { return Cycle::footprint(picks_max); }
  // The thread waits for start().
  Station(const StationParts& parts, const Config& config, Arena& arena);
  // After the cycle that runs.
  ~Station();
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;

  void start();
  // False: an order of the same source waits already (the PLC's is then replaced and true), or the
  // station ends.
  bool offer(const Order& order);
  void set_plc_lost(bool lost);
  // What may change while it runs is taken over before the next order.
  void reload(const Config& config);
  StationStatus status() const;
  // Counted up with each step of the thread, and at least every 250 ms while it waits for orders:
  // what the watchdog is fed by.
  std::uint64_t progress() const { return progress_.load(std::memory_order_relaxed); }
  // Asks the thread to end; the destructor waits for it.
  void stop();

 private:
  struct Reload {
    StationSettings settings;
    std::vector<RecipeConfig> recipes;
  };

  void work();
  std::optional<Order> next_order();
  std::optional<Order> take_order();
  bool free_run_due() const;
  void carry_out(const Order& order);
  void take_over_reload();
  void tell_status();
  StationStatus status_now() const;  // mutex_ is held
  StationStatus keep_status();

  const StationParts parts_;
  Cycle cycle_;
  std::atomic<std::uint64_t> progress_{0};

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool started_ = false, stopping_ = false;
  bool plc_lost_ = false;
  std::optional<Order> plc_order_, control_order_;
  bool plc_order_replaced_one_ = false;
  std::uint64_t orders_replaced_ = 0;
  std::optional<Reload> reload_;
  bool reload_fresh_ = false;
  StationStatus status_;  // as last told

  // The thread's own.
  Order order_;
  bool busy_ = false, plc_lost_seen_ = false, order_replaced_one_ = false;
  std::int64_t free_run_due_ns_ = 0;
  std::uint32_t free_run_sequence_ = 0;

  std::thread thread_;  // last: everything it uses is made before it
};

}  // namespace binpick::app
