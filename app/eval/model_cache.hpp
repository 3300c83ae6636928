// Trained models kept in a folder between runs. A file's name holds a hash of the mesh and of every
// option of training, so a change of either trains anew.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "training/part_training.hpp"

namespace binpick::app {

// Counts changes of the trainer that give other models from the same options: raising it makes
// every cached model out of date.
inline constexpr int kTrainerRevision = 5;
// The same of the detector, as far as trials in simulated piles tell something else. The templates
// stay.
inline constexpr int kTrialsRevision = 6;
// No trials: templates alone.
inline constexpr TrialPlan kNoTrials{.calibration_piles = 0, .test_piles = 0};

// FNV-1a 64 over the mesh's hash, the revisions and all options; without trials those of trials
// left out.
std::uint64_t training_key(std::uint64_t mesh_hash, const train::TrainOptions& options,
                           const TrialPlan& trials);

class ModelCache {
 public:
  // Makes the folder if needed; throws SetupError when that fails. Without a folder ("")
  // nothing is found and nothing is kept.
  explicit ModelCache(const std::string& folder);

  std::optional<std::vector<std::uint8_t>> find(int obj_id, std::uint64_t key) const;
  // Complete or not at all. Throws SetupError.
  void keep(int obj_id, std::uint64_t key, const std::vector<std::uint8_t>& model) const;
  std::string path_of(int obj_id, std::uint64_t key) const;

 private:
  std::string folder_;
};

}  // namespace binpick::app
