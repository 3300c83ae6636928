// The station's own cycle over recorded frames and commands: the same code from the order to the
// registers, without sensor, PLC and clock. Deadlines are left out, since they depend on the
// machine. Thread: one.
#pragma once

#include <optional>

#include "binpick/drivers/bop_dataset.hpp"
#include "replay/recording.hpp"
#include "station/cycle.hpp"
#include "thread_pool.hpp"

namespace binpick::app {

class StationReplay {
 public:
  // Throws SetupError, DatasetError. Outlived by the recording.
  StationReplay(const Config& config, const Recording& recording);
  StationReplay(const StationReplay&) = delete;
  StationReplay& operator=(const StationReplay&) = delete;

  const RecipeSet& recipes() const { return recipes_; }
  struct Answer {
    modbus::AnswerRegisters registers{};
    // Not null: how the order ended depended on more than its frame, its command and what the
    // recording holds before it; nothing is to be compared.
    const char* not_comparable = nullptr;
  };
  // In the order of the recording.
  Answer run(const RecordedCycle& cycle);

 private:
  // Hands out the frame of the cycle that runs, or the fault that it had.
  class Frames final : public FrameSource {
   public:
    explicit Frames(FramePool& pool) : pool_(pool) {}
    Result<FrameRef> grab(std::chrono::steady_clock::time_point deadline) override;
    void set(const drivers::LoadedFrame* frame, ErrorCode fault) { frame_ = frame, fault_ = fault; }

   private:
    FramePool& pool_;
    const drivers::LoadedFrame* frame_ = nullptr;
    ErrorCode fault_ = ErrorCode::kNone;
  };

  Order order_of(const RecordedCycle& recorded);
  const char* why_not_comparable(const RecordedCycle& recorded, const Order& order) const;
  void follow(const RecordedCycle& recorded, const Order& order);
  bool keep_frame(const Order& process);

  const Config config_;
  RecipeSet recipes_;
  FramePoolParams pool_params_;
  ThreadPool workers_;
  Arena arena_;
  FramePool pool_;
  Detector detector_;
  Frames frames_;
  Cycle cycle_;
  std::optional<drivers::BopDataset> data_;  // none: no cycle has a frame
  drivers::BopScene scene_;
  // The order that grabbed last, for the flange's pose; none: it is not in the recording.
  std::optional<Order> captured_;
  std::uint64_t last_record_ = 0;
  // What the cycle holds is what the station's did: an order without a frame can be carried out.
  bool in_step_ = true;
};

// One register that differs, and its words.
struct RegisterDifference {
  const char* name = "";
  std::uint32_t recorded = 0, replayed = 0;
};
// Without those that vary from run to run, as the register map says.
std::vector<RegisterDifference> differences(const modbus::AnswerRegisters& recorded,
                                            const modbus::AnswerRegisters& replayed);

}  // namespace binpick::app
