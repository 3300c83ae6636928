// From a CAD file to a model that knows what it can do: training, then simulated piles to calibrate
// the score with, then others to test the whole on.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "binpick/train/trainer.hpp"
#include "simulation/sensor_kind.hpp"
#include "training/self_test.hpp"

namespace binpick::app {

struct TrialPlan {
  int calibration_piles = 8;  // 0: the score stays as the evidence has it
  int test_piles = 4;         // 0: no self-test
  std::optional<simulation::SensorKind> sensor_kind = {};  // that sees them; else all kinds in turn
};

struct TrainedPart {
  std::vector<std::uint8_t> model;
  std::optional<SelfTest> self_test;
  std::vector<std::string> advice;  // from the self-test, for people
};

// What is being done, and the share of it that is done.
using PartTrainingProgress = std::function<void(const std::string& step, double share)>;

// Templates, then what trials tell. Throws what train_model throws. The same part, options and plan
// give the same bytes.
TrainedPart train_part(const train::ImportedMesh& part, const train::TrainOptions& options,
                       const TrialPlan& plan, WorkerPool& pool,
                       const PartTrainingProgress& progress);

// The second half alone: `model` is what train_model made of the part with these options.
TrainedPart try_part(std::vector<std::uint8_t> model, const train::ImportedMesh& part,
                     const train::TrainOptions& options, const TrialPlan& plan, WorkerPool& pool,
                     const PartTrainingProgress& progress);

}  // namespace binpick::app
