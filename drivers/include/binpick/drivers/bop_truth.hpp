// The truth of a BOP data set: for scoring and for drawing reports, never for training or
// detection. Every fault is a DatasetError that names the file.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "binpick/drivers/bop_dataset.hpp"

namespace binpick::drivers {

struct TruthInstance {
  int obj_id = 0;
  Pose T_cam_obj;
  double visible_fraction = 1;  // of its silhouette, from scene_gt_info.json
};

// Image id to the instances in it, in the order of scene_gt.json. Empty where the scene has no
// scene_gt.json. Without scene_gt_info.json every instance counts as wholly visible.
std::map<int, std::vector<TruthInstance>> load_truth(const BopDataset& dataset, int scene_id);

// Which objects are to be looked for in which frame: test_targets_bop19.json, else
// test_targets_bop24.json, which lists frames alone (no objects: any that are in it). Nothing when
// the data set has neither.
std::optional<std::map<FrameId, std::set<int>>> load_targets(const BopDataset& dataset);

}  // namespace binpick::drivers
