#include "training/pile_trial.hpp"

#include <algorithm>
#include <stdexcept>

#include "clock.hpp"
#include "error_text.hpp"
#include "sized_detector.hpp"

namespace binpick::app {
namespace {

constexpr int kResultsMax = 200;

DetectorLimits limits_of(const std::vector<SimulatedPile>& piles) {
  DetectorLimits limits;
  limits.results_max = kResultsMax;
  for (const SimulatedPile& pile : piles) {
    limits.image_width = pile.frame.camera.width;
    limits.image_height = pile.frame.camera.height;
    limits.roi_width = std::max(limits.roi_width, pile.frame.roi.width);
    limits.roi_height = std::max(limits.roi_height, pile.frame.roi.height);
  }
  return limits;
}

std::vector<ScoredInstance> scored(const SimulatedPile& pile) {
  std::vector<ScoredInstance> out;
  for (const drivers::TruthInstance& truth : pile.truth) {
    out.push_back({truth, origin_inside(pile.frame.camera, pile.frame.roi, truth.T_cam_obj)});
  }
  return out;
}

}  // namespace

PileTrial run_trial(const ObjectModel& model, const std::vector<SimulatedPile>& piles,
                    Modality modality, WorkerPool& pool, const train::TrainProgress& progress) {
  const std::vector<ObjectModel> models = {model};
  SizedDetector sized(models, limits_of(piles), DetectorParams{}, pool);
  DetectRequest request;
  request.max_results = kResultsMax;
  request.min_score = 0;
  request.modality = modality;
  PileTrial trial;
  for (std::size_t i = 0; i < piles.size(); ++i) {
    const drivers::FrameId id{1, static_cast<int>(i)};
    trial.truth[id] = scored(piles[i]);
    const Frame frame = piles[i].frame.view();
    const std::int64_t begin_ns = monotonic_ns();
    const Result<DetectionReport> report = sized.detector().detect(frame, request);
    if (!report.ok()) throw std::runtime_error("a simulated pile: " + error_text(report.error()));
    trial.time_s[id] = static_cast<double>(monotonic_ns() - begin_ns) * 1e-9;
    for (const Detection& d : report.value().detections) {
      trial.rows.push_back({id, kPileObject, d.score, d.T_cam_obj, trial.time_s[id]});
      trial.uncertainty.push_back(d.uncertainty);
    }
    progress(static_cast<double>(i + 1) / static_cast<double>(piles.size()));
  }
  return trial;
}

bool is_right(const PartGeometry& geometry, const Pose& estimate, const Pose& truth,
              const PoseLimits& limits) {
  return (truth.t_mm - estimate.t_mm).norm() < geometry.diameter_mm() &&
         relative_error(geometry.six_errors(estimate, truth, limits), limits) < 1;
}

std::vector<bool> right_rows(const PileTrial& trial, const PartGeometry& geometry,
                             const PoseLimits& limits) {
  std::vector<bool> right;
  for (const ResultRow& row : trial.rows) {
    const std::vector<ScoredInstance>& instances = trial.truth.at(row.frame);
    right.push_back(
        std::any_of(instances.begin(), instances.end(), [&](const ScoredInstance& instance) {
          return is_right(geometry, row.T_cam_obj, instance.truth.T_cam_obj, limits);
        }));
  }
  return right;
}

}  // namespace binpick::app
