// What detection makes of simulated piles.
#pragma once

#include <map>
#include <vector>

#include "binpick/base/worker_pool.hpp"
#include "binpick/model/object_model.hpp"
#include "binpick/report/pose_uncertainty.hpp"
#include "eval/bop_results.hpp"
#include "eval/part_geometry.hpp"
#include "eval/score_truth.hpp"
#include "training/pile_maker.hpp"

namespace binpick::app {

struct PileTrial {
  TruthByFrame truth;
  std::vector<ResultRow> rows;
  std::vector<PoseUncertainty> uncertainty;  // of each row
  std::map<drivers::FrameId, double> time_s;
};

// Every pose that the detector is willing to report, however improbable. Throws std::runtime_error
// where a pile cannot be searched.
PileTrial run_trial(const ObjectModel& model, const std::vector<SimulatedPile>& piles,
                    Modality modality, WorkerPool& pool, const train::TrainProgress& progress);

// Whether a pose is that of a part, for the best of the part's symmetries.
bool is_right(const PartGeometry& geometry, const Pose& estimate, const Pose& truth,
              const PoseLimits& limits);

// Whether the pose of each row is right within `limits`, whatever can be seen of the part.
std::vector<bool> right_rows(const PileTrial& trial, const PartGeometry& geometry,
                             const PoseLimits& limits);

}  // namespace binpick::app
