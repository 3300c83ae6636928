// What an evaluation is to do: which objects to look for in which frame, and which frames share a
// camera.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "binpick/drivers/bop_dataset.hpp"
#include "eval/score_truth.hpp"

namespace binpick::app {

struct WantedFrame {
  drivers::FrameId id;
  std::set<int> objects;
  std::size_t camera_index = 0;  // into EvalPlan::cameras
};

// Frames taken with (nearly) the same intrinsics; one model of a part serves them all.
struct CameraGroup {
  CameraIntrinsics camera;          // of the first frame; its size is known once a frame was read
  std::vector<std::size_t> frames;  // into EvalPlan::frames
};

struct EvalPlan {
  std::map<int, drivers::BopScene> scenes;
  std::vector<WantedFrame> frames;
  std::vector<CameraGroup> cameras;
  TruthByFrame truth;               // of the frames that will be looked at; may be empty
  std::vector<std::string> faults;  // scenes that cannot be read: a sentence each

  std::set<int> objects() const;
};

struct EvalSelection {
  std::set<int> scenes;   // empty: all
  std::set<int> objects;  // empty: all
};

// A frame's objects are those that test_targets_bop19.json lists or, without that file, the kinds
// of object in its truth; without truth, those asked for. test_targets_bop24.json only chooses
// frames. Throws DatasetError when a scene is asked for that does not exist, or
// nothing is left to do.
EvalPlan make_eval_plan(const drivers::BopDataset& dataset, const EvalSelection& selection);

}  // namespace binpick::app
