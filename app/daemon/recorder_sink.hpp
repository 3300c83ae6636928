// Hands the station's cycles to the recorder: what a result, its order and the published registers
// are as a record. Thread: on_result() the cycle's; the rest main.
#pragma once

#include "daemon/modbus_link.hpp"
#include "recorder/cycle_recorder.hpp"
#include "station/recipe_set.hpp"

namespace binpick::app {

class RecorderSink final : public StationSink {
 public:
  static std::size_t footprint(const Config& config);
  // `link`: whose registers are recorded; null where there is no Modbus server: then those that it
  // would publish. Outlives the sink. Throws SetupError.
  RecorderSink(const Config& config, const RecipeSet& recipes, const ModbusLink* link,
               Arena& arena);

  void on_status(const StationStatus&) override {}
  void on_result(const CycleResult& result, const StationStatus& status,
                 const FrameRef& kept_frame) override;

  // After a reload, whose live values are those of the cycles from now on.
  void reload(const Config& config, const RecipeSet& recipes);
  CycleRecorder& recorder() { return recorder_; }

 private:
  const modbus::Encoding encoding_;
  const ModbusLink* link_;
  CycleRecorder recorder_;
};

}  // namespace binpick::app
