// The last answer to each source of orders, for whoever looks at them at his own pace: the control
// socket and the log, on the main thread. A copy behind a short lock; a write to an event
// descriptor says that there is something new. Thread-safe; the cycle's side allocates nothing.
#pragma once

#include <array>
#include <mutex>
#include <vector>

#include "binpick/base/arena.hpp"
#include "station/station.hpp"

namespace binpick::app {

class ResultBoard final : public StationSink {
 public:
  static constexpr int kSources = 3;  // OrderSource

  static std::size_t footprint(int picks_max);
  // Throws SetupError where no event descriptor can be had.
  ResultBoard(int picks_max, Arena& arena);
  ~ResultBoard() override;
  ResultBoard(const ResultBoard&) = delete;
  ResultBoard& operator=(const ResultBoard&) = delete;

  void on_status(const StationStatus&) override {}
  void on_result(const CycleResult& result, const StationStatus& status,
                 const FrameRef& kept_frame) override;

  // Readable when there is a new answer.
  int descriptor() const { return descriptor_; }
  void clear_event();

  struct Brief {
    std::uint64_t number = 0;  // of the source's answers; 0: none yet
    CycleResult result;        // without its picks
    std::size_t pick_count = 0;
  };
  // Allocates nothing.
  Brief brief(OrderSource source) const;

  struct Copy {
    CycleResult result;  // its picks are those below
    std::vector<Pick> picks;
  };
  Copy last(OrderSource source) const;

 private:
  struct Entry {
    std::uint64_t number = 0;
    CycleResult result;
    std::span<Pick> picks;
  };

  mutable std::mutex mutex_;
  std::array<Entry, kSources> entries_;
  int descriptor_ = -1;
};

}  // namespace binpick::app
