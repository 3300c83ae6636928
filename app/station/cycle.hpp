// One order after the other, each from its acceptance to its answer: the station's state machine.
//
//   idle, done, fault --detect, capture--> grabbing --detect--> computing --> done
//                     --process------------------------------^
//
// What fails on the way leads to fault. A frame that was captured is kept until the next one is
// grabbed. Allocates nothing after construction. Thread: the cycle's; state() any.
#pragma once

#include <atomic>
#include <chrono>

#include "binpick/base/clock.hpp"
#include "binpick/frame/frame_pool.hpp"
#include "station/ranking.hpp"
#include "station/settings.hpp"

namespace binpick::app {

// Where frames come from: a sensor session, or a recording that is replayed.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  // A frame taken after this call, or an Error with one of core's sensor codes; never later than
  // the deadline. Allocates nothing.
  virtual Result<FrameRef> grab(std::chrono::steady_clock::time_point deadline) = 0;
};

struct CycleParts {
  RecipeSet& recipes;
  Detector& detector;
  FrameSource& source;
  ClockFn clock;
  // Called at each step: whoever watches sees that the cycle lives. May be null.
  void (*progress)(void* context) = nullptr;
  void* progress_context = nullptr;
};

class Cycle {
 public:
  // What the constructor takes from its arena.
  static std::size_t footprint(int picks_max);
  Cycle(const CycleParts& parts, const StationSettings& settings, int picks_max, int first_recipe,
        Arena& arena);

  // The answer; borrowed until the next run.
  const CycleResult& run(const Order& order);
  void set_settings(const StationSettings& settings) { settings_ = settings; }
  const StationSettings& settings() const { return settings_; }

  StationState state() const { return state_.load(std::memory_order_acquire); }
  int selected_recipe() const { return selected_.load(std::memory_order_relaxed); }
  // Between cycles. Lost: free running ends, the state is fault, the PLC's orders are refused.
  void set_plc_lost(bool lost);
  void set_free_running(bool on) { free_running_.store(on, std::memory_order_relaxed); }
  bool free_running() const { return free_running_.load(std::memory_order_relaxed); }
  const CycleResult& result() const { return result_; }
  // The frame that the last order used; empty when there is none. For the recorder.
  const FrameRef& kept_frame() const { return frame_; }

 private:
  Cause refusal(const Order& order) const;
  Cause cause_without_cycle(const Order& order);
  Cause turn_page(int page);
  StationState begin(const Order& order);
  StationState grab();
  StationState compute();
  StationState end(Cause cause);
  bool refuses(const Frame& frame);
  void explain(const DetectionReport& report);
  void rank(const DetectionReport& report);
  void finish(StationState state);
  void enter(StationState state);
  void leave_fault();
  Pose T_base_cam() const;
  int wanted_picks() const;

  CycleParts parts_;
  StationSettings settings_;
  std::span<Pick> picks_;
  std::span<int> ranking_;
  CycleResult result_;
  FrameRef frame_;
  // Of frame_.
  Pose T_base_flange_at_capture_;
  bool captured_with_flange_ = false;
  std::int64_t capture_ns_ = 0, capture_unix_ns_ = 0;
  const Recipe* recipe_ = nullptr;
  std::int64_t begun_ns_ = 0, deadline_ns_ = 0;
  bool plc_lost_ = false;
  std::atomic<int> selected_;
  std::atomic<bool> free_running_{false};
  std::atomic<StationState> state_{StationState::kIdle};
};

}  // namespace binpick::app
