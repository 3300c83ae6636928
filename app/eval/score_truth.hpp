// The truth as scoring sees it: per frame every instance, and whether its origin is inside the ROI.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "binpick/drivers/bop_truth.hpp"

namespace binpick::app {

struct ScoredInstance {
  drivers::TruthInstance truth;
  bool origin_in_roi = true;
};

// Whether the part's origin projects into the region of interest.
bool origin_inside(const CameraIntrinsics& camera, const Roi& roi, const Pose& T_cam_obj);

using TruthByFrame = std::map<drivers::FrameId, std::vector<ScoredInstance>>;

// The truth of these scenes; where the data set lists its targets, of the frames listed. Throws
// DatasetError.
TruthByFrame load_score_truth(const drivers::BopDataset& dataset, const std::set<int>& scene_ids);

// The instances of one scene, as above.
TruthByFrame load_score_truth(const drivers::BopDataset& dataset, const drivers::BopScene& scene);

}  // namespace binpick::app
