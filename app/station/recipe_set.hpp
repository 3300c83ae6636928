// The parts that the station can pick, loaded at start: one table of models for one detector, so
// that the frame's pyramid is paid for once, and for each recipe which of them it looks for.
// Choosing a recipe allocates nothing. Set-up, then the cycle's thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "binpick/detect/detector.hpp"
#include "config/config_file.hpp"
#include "model_file.hpp"

namespace binpick::app {

// As written in a configuration, whose checks it passed; angles are R = Rz Ry Rx of fixed axes.
Pose pose_of(const WrittenPose& written);

struct Recipe {
  int number = 0;
  std::string name;
  std::vector<int> models;  // indices into RecipeSet::models()
  Roi roi;                  // width 0: the frame's own
  Modality modality = Modality::kAutomatic;
  NearSymmetry near_symmetry = NearSymmetry::kAuto;
  double min_score = 0;
  int picks_max = 0;
  Pose T_obj_pick;
};

class RecipeSet {
 public:
  // Reads the model files, each once. Throws SetupError.
  explicit RecipeSet(const Config& config);

  std::span<const ObjectModel> models() const { return models_; }
  std::span<const std::unique_ptr<ModelFile>> files() const { return files_; }
  std::span<const Recipe> recipes() const { return recipes_; }
  // nullptr: no recipe has that number.
  const Recipe* find(int number) const;
  DetectorLimits limits() const { return limits_; }
  ReloadLimits reload_limits() const;
  // What a reload may change, of recipes with the same numbers in the same order, within
  // reload_limits().
  void take_live_values(std::span<const RecipeConfig> recipes);

 private:
  std::vector<std::unique_ptr<ModelFile>> files_;
  std::vector<ObjectModel> models_;
  std::vector<Recipe> recipes_;
  DetectorLimits limits_;
};

}  // namespace binpick::app
