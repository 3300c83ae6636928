#include "station/recipe_set.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "setup_error.hpp"

namespace binpick::app {
namespace {

Roi roi_of(const std::array<double, 4>& px) {
  return {static_cast<int>(px[0]), static_cast<int>(px[1]), static_cast<int>(px[2]),
          static_cast<int>(px[3])};
}

DetectorLimits limits_of(const Config& config, std::span<const Recipe> recipes) {
  DetectorLimits limits;
  limits.image_width = config.sensor.width_max;
  limits.image_height = config.sensor.height_max;
  limits.results_max = config.station.picks_max;
  for (const Recipe& recipe : recipes) {
    if (recipe.roi.whole_image()) {
      limits.roi_width = limits.roi_height = 0;
      break;
    }
    limits.roi_width = std::max(limits.roi_width, recipe.roi.width);
    limits.roi_height = std::max(limits.roi_height, recipe.roi.height);
  }
  return limits;
}

}  // namespace

Pose pose_of(const WrittenPose& written) {
  const auto& p = written.position_mm;
  const Vec3 position(p[0], p[1], p[2]);
  if (!written.matrix.empty()) {
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> T(written.matrix.data());
    return {orthonormalized(T.topLeftCorner<3, 3>()), T.topRightCorner<3, 1>()};
  }
  const auto turned = [&](double w, double x, double y, double z) {
    return Pose{Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix(), position};
  };
  if (const auto& q = written.quaternion_wxyz; !q.empty()) return turned(q[0], q[1], q[2], q[3]);
  if (const auto& q = written.quaternion_xyzw; !q.empty()) return turned(q[3], q[0], q[1], q[2]);
  const auto about = [&](int axis) {
    const double angle_rad = written.rotation_deg[static_cast<std::size_t>(axis)] * kDegree;
    return rotation_from_vector(angle_rad * Vec3::Unit(axis));
  };
  return {orthonormalized(about(2) * about(1) * about(0)), position};
}

RecipeSet::RecipeSet(const Config& config) {
  for (const RecipeConfig& written : config.recipes) {
    Recipe recipe;
    recipe.number = written.number;
    for (const std::string& path : written.models) {
      const auto same = [&](const auto& file) { return file->path() == path; };
      const auto found = std::find_if(files_.begin(), files_.end(), same);
      recipe.models.push_back(static_cast<int>(found - files_.begin()));
      if (found == files_.end()) files_.push_back(std::make_unique<ModelFile>(path));
    }
    recipes_.push_back(std::move(recipe));
  }
  for (const auto& file : files_) {
    if (file->model().info().normal_codebook != files_[0]->model().info().normal_codebook)
      throw SetupError(file->path() + ": trained with another --normal-codebook than " +
                       files_[0]->path() + "; a station's models share one");
    models_.push_back(file->model());
  }
  take_live_values(config.recipes);
  limits_ = limits_of(config, recipes_);
}

ReloadLimits RecipeSet::reload_limits() const {
  const bool whole = limits_.roi_width == 0;
  return {limits_.image_width, limits_.image_height,
          whole ? limits_.image_width : limits_.roi_width,
          whole ? limits_.image_height : limits_.roi_height};
}

const Recipe* RecipeSet::find(int number) const {
  for (const Recipe& recipe : recipes_) {
    if (recipe.number == number) return &recipe;
  }
  return nullptr;
}

void RecipeSet::take_live_values(std::span<const RecipeConfig> recipes) {
  for (std::size_t i = 0; i < recipes_.size() && i < recipes.size(); ++i) {
    if (recipes[i].number != recipes_[i].number) continue;
    recipes_[i].roi = roi_of(recipes[i].roi_px);
    recipes_[i].modality = recipes[i].modality;
    recipes_[i].near_symmetry = recipes[i].near_symmetry;
    recipes_[i].min_score = recipes[i].min_score;
    recipes_[i].picks_max = recipes[i].picks_max;
    recipes_[i].T_obj_pick = pose_of(recipes[i].T_obj_pick);
  }
}

}  // namespace binpick::app
