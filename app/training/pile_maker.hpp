// Piles of one part as the station's sensor may see them, with the truth: what training learns the
// score from, and tests itself on. The part falls into a bin of about three of its diameters; the
// camera is the one trained for, somewhere in the distances trained for; depth noise, missing depth
// and light differ from pile to pile, as nothing is known of the sensor but its camera.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "binpick/base/worker_pool.hpp"
#include "binpick/drivers/bop_truth.hpp"
#include "binpick/drivers/loaded_frame.hpp"
#include "binpick/train/trainer.hpp"
#include "simulation/frame_maker.hpp"
#include "simulation/sensor_kind.hpp"

namespace binpick::app {

struct SimulatedPile {
  drivers::LoadedFrame frame;
  std::vector<drivers::TruthInstance> truth;  // of object kPileObject
};

inline constexpr int kPileObject = 1;

class PileMaker {
 public:
  // Prepares what collides, which takes a second or two.
  // Without a kind of sensor, all kinds in turn.
  PileMaker(const train::ImportedMesh& part, const train::TrainOptions& options,
            std::optional<simulation::SensorKind> kind);

  // `count` piles; the same seed gives the same piles on any number of threads.
  std::vector<SimulatedPile> make(int count, std::uint64_t seed, WorkerPool& pool,
                                  const train::TrainProgress& progress = {}) const;

 private:
  SimulatedPile make_one(std::uint64_t seed, simulation::SensorKind kind) const;

  std::vector<simulation::SensorKind> kinds_;

  // The simulation is made for parts of one size, so lengths in it are this times the real ones.
  double scale_;
  CameraIntrinsics camera_;
  double distance_min_mm_, distance_max_mm_;  // real
  simulation::BinSize bin_;                   // in the simulation
  std::vector<simulation::Part> parts_;       // the one
  simulation::FrameMaker maker_;
};

}  // namespace binpick::app
