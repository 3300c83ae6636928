// A station without sensor and files for tests: rendered brackets, a scripted source of frames.
#pragma once

#include <chrono>
#include <deque>
#include <fstream>
#include <memory>
#include <mutex>
#include <thread>

#include "binpick/base/worker_pool.hpp"
#include "clock.hpp"
#include "core/bracket.hpp"
#include "station/station.hpp"
#include "temporary_folder.hpp"

namespace binpick::app {

// Gives what the script says, or the scene.
class ScriptedSource final : public FrameSource {
 public:
  ScriptedSource() : arena_(FramePool::footprint({3, 480, 360})), pool_({3, 480, 360}, arena_) {}

  Result<FrameRef> grab(std::chrono::steady_clock::time_point deadline) override {
    ++grabs;
    if (wait_for_deadline) {
      std::this_thread::sleep_until(deadline);
      return Error{ErrorCode::kSensorTimeout, 0, "test"};
    }
    if (error != ErrorCode::kNone) return Error{error, 0, "test"};
    FrameRef ref = pool_.try_take();
    if (!ref) return Error{ErrorCode::kSensorFrameDropped, 0, "test"};
    const Frame& source = scene->frame();
    FrameSlot& slot = ref.slot();
    slot.frame = source;
    if (!blank) {
      std::copy_n(source.depth_mm.data, scene->depth_mm.size(), slot.depth_mm.begin());
    } else {
      std::fill(slot.depth_mm.begin(), slot.depth_mm.end(), 0.0f);
    }
    std::copy_n(source.intensity.data, scene->gray.size(), slot.intensity.begin());
    slot.frame.depth_mm.data = slot.depth_mm.data();
    slot.frame.intensity.data = slot.intensity.data();
    if (without_depth) slot.frame.depth_mm = {};
    if (without_intensity) slot.frame.intensity = {};
    if (bad_camera) slot.frame.camera.fx = 0;
    slot.frame.sequence = static_cast<std::uint64_t>(grabs);
    slot.frame.capture_ns = monotonic_ns();
    return ref;
  }

  const BracketScene* scene = nullptr;
  bool wait_for_deadline = false, blank = false, bad_camera = false;
  bool without_depth = false, without_intensity = false;
  ErrorCode error = ErrorCode::kNone;
  int grabs = 0;

 private:
  Arena arena_;
  FramePool pool_;
};

inline const BracketScene& bracket_scene() {
  static const BracketScene once = render_brackets(bracket_camera(), three_brackets(), 0.1);
  return once;
}

// Two recipes: number 1 as it is, number 7 with a high score.
struct StationBench {
  explicit StationBench(const std::vector<std::uint8_t>& model = bracket_model_bytes()) {
    std::ofstream(folder.file("bracket.bpm"), std::ios::binary)
        .write(reinterpret_cast<const char*>(model.data()),
               static_cast<std::streamsize>(model.size()));
    config.sensor.width_max = 480;
    config.sensor.height_max = 360;
    config.sensor.frame_deadline_ms = 50;
    config.station.picks_max = 16;
    for (const int number : {1, 7}) {
      RecipeConfig recipe;
      recipe.number = number;
      recipe.models = {folder.file("bracket.bpm")};
      recipe.min_score = number == 7 ? 1 : 0.4;
      config.recipes.push_back(recipe);
    }
    source.scene = &bracket_scene();
  }
  // After the configuration has been changed as wanted.
  void make() {
    recipes = std::make_unique<RecipeSet>(config);
    const DetectorLimits limits = recipes->limits();
    arena = std::make_unique<Arena>(Detector::footprint(recipes->models(), limits, {}, 1) +
                                    Station::footprint(config.station.picks_max));
    detector = std::make_unique<Detector>(recipes->models(), limits, DetectorParams{}, pool, clock,
                                          *arena);
  }
  Cycle& cycle() {
    if (!recipes) make();
    if (!cycle_) {
      cycle_ = std::make_unique<Cycle>(
          CycleParts{*recipes, *detector, source, clock, nullptr, nullptr}, settings_of(config),
          config.station.picks_max, config.recipes[0].number, *arena);
    }
    return *cycle_;
  }
  const CycleResult& run(Order order) {
    order.received_ns = clock();
    return cycle().run(order);
  }
  const CycleResult& run(OrderCode code) {
    Order order;
    order.code = code;
    return run(order);
  }

  TemporaryFolder folder;
  Config config;
  ClockFn clock = monotonic_ns;
  ScriptedSource source;
  SerialPool pool;
  std::unique_ptr<RecipeSet> recipes;
  std::unique_ptr<Arena> arena;
  std::unique_ptr<Detector> detector;

 private:
  std::unique_ptr<Cycle> cycle_;
};

}  // namespace binpick::app
