#include "eval/model_cache.hpp"

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "replace_file.hpp"
#include "setup_error.hpp"

namespace fs = std::filesystem;

namespace binpick::app {
namespace {

// Text rather than bytes of the struct: padding and the order of members do not matter.
std::string description(std::uint64_t mesh_hash, const train::TrainOptions& o,
                        const TrialPlan& trials) {
  std::string text =
      "revision " + std::to_string(kTrainerRevision) + " mesh " + std::to_string(mesh_hash);
  const auto add = [&text](const char* name, double value) {
    char number[32];
    const auto end = std::to_chars(number, number + sizeof number, value).ptr;
    text.append(" ").append(name).append(" ").append(number, end);
  };
  add("width", o.camera.width), add("height", o.camera.height);
  add("fx", o.camera.fx), add("fy", o.camera.fy), add("cx", o.camera.cx), add("cy", o.camera.cy);
  add("distance_min_mm", o.distance_min_mm), add("distance_max_mm", o.distance_max_mm);
  add("tilt_max_deg", o.tilt_max_deg);
  add("samples", o.samples);
  add("gradient_threshold", o.gradient_threshold), add("normal_threshold", o.normal_threshold);
  add("tilt_jitter_deg", o.tilt_jitter_deg), add("roll_jitter_deg", o.roll_jitter_deg);
  add("distance_jitter_mm", o.distance_jitter_mm);
  add("roll_interval_deg", o.roll_interval_deg),
      add("distance_interval_mm", o.distance_interval_mm);
  add("tree_depths", o.tree_depths);
  add("normal_codebook", static_cast<double>(o.normal_codebook));
  add("contour_features", o.contour_features), add("surface_features", o.surface_features);
  add("calibration_piles", trials.calibration_piles), add("test_piles", trials.test_piles);
  if (trials.calibration_piles > 0 || trials.test_piles > 0) add("trials", kTrialsRevision);
  if (trials.sensor_kind) add("sensor_kind", static_cast<double>(*trials.sensor_kind));
  return text + " seed " + std::to_string(o.seed);
}

}  // namespace

std::uint64_t training_key(std::uint64_t mesh_hash, const train::TrainOptions& options,
                           const TrialPlan& trials) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : description(mesh_hash, options, trials)) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  }
  return hash;
}

ModelCache::ModelCache(const std::string& folder) : folder_(folder) {
  if (folder_.empty()) return;
  std::error_code error;
  fs::create_directories(folder_, error);
  if (!fs::is_directory(folder_)) {
    throw SetupError(folder_ + ": the folder for trained models cannot be made");
  }
}

std::string ModelCache::path_of(int obj_id, std::uint64_t key) const {
  char name[64];
  std::snprintf(name, sizeof name, "obj_%06d_%016llx.bpm", obj_id,
                static_cast<unsigned long long>(key));
  return (fs::path(folder_) / name).string();
}

std::optional<std::vector<std::uint8_t>> ModelCache::find(int obj_id, std::uint64_t key) const {
  if (folder_.empty()) return std::nullopt;
  std::ifstream file(path_of(obj_id, key), std::ios::binary);
  if (!file) return std::nullopt;
  return std::vector<std::uint8_t>(std::istreambuf_iterator<char>(file), {});
}

void ModelCache::keep(int obj_id, std::uint64_t key, const std::vector<std::uint8_t>& model) const {
  if (folder_.empty()) return;
  replace_file(path_of(obj_id, key), model);
}

}  // namespace binpick::app
