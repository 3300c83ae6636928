#include "training/part_training.hpp"

#include <stdexcept>

#include "binpick/detect/detector.hpp"
#include "error_text.hpp"
#include "training/score_calibration.hpp"

namespace binpick::app {
namespace {

// Apart from each other, and from the seed of the templates' samples.
constexpr std::uint64_t kCalibrationSeed = 0x63616c6962726174;
constexpr std::uint64_t kTestSeed = 0x73656c6674657374;
// Poses of small parts have to be nearer than the limits of the bin-picking experiment.
constexpr double kLimitInDiameters = 0.075;

ObjectModel parsed(const std::vector<std::uint8_t>& bytes) {
  const Result<ObjectModel> model = ObjectModel::parse(bytes);
  if (!model.ok()) {
    throw std::runtime_error("the model just trained is not valid: " + error_text(model.error()));
  }
  return model.value();
}

PartGeometry geometry_of(const ObjectModel& model, const train::Mesh& mesh) {
  drivers::BopModel part;
  part.obj_id = kPileObject;
  part.diameter_mm = model.info().diameter_mm;
  return PartGeometry(part, mesh);
}

ScoreCalibration calibrate(const PileTrial& trial, const PartGeometry& geometry) {
  PoseLimits limits;
  limits.mm = std::min(limits.mm, kLimitInDiameters * geometry.diameter_mm());
  const std::vector<bool> right = right_rows(trial, geometry, limits);
  std::vector<JudgedScore> poses;
  for (std::size_t i = 0; i < right.size(); ++i) poses.push_back({trial.rows[i].score, right[i]});
  return fit_calibration(poses);
}

}  // namespace

TrainedPart train_part(const train::ImportedMesh& part, const train::TrainOptions& options,
                       const TrialPlan& plan, WorkerPool& pool,
                       const PartTrainingProgress& progress) {
  const auto tell = [&](const char* what, double share) {
    if (progress) progress(what, share);
  };
  TrainedPart out;
  out.model =
      train::train_model(part, options, pool, [&](double share) { tell("training", share); });
  if (plan.calibration_piles <= 0 && plan.test_piles <= 0) return out;

  const PartGeometry geometry = geometry_of(parsed(out.model), part.mesh);
  const PileMaker maker(part, options);
  ModelTrials trials;
  if (plan.calibration_piles > 0) {
    tell("calibration", 0);
    const auto piles = maker.make(plan.calibration_piles, options.seed ^ kCalibrationSeed, pool);
    tell("calibration", 0.9);
    const ObjectModel model = parsed(out.model);
    trials.with_intensity =
        calibrate(run_trial(model, piles, TrialSees::kDepthAndIntensity, pool), geometry);
    trials.depth_alone = calibrate(run_trial(model, piles, TrialSees::kDepthAlone, pool), geometry);
    trials.calibration_piles = plan.calibration_piles;
    train::set_trials(out.model, trials);
    tell("calibration", 1);
  }
  if (plan.test_piles > 0) {
    tell("self-test", 0);
    const auto piles = maker.make(plan.test_piles, options.seed ^ kTestSeed, pool);
    tell("self-test", 0.9);
    const PileTrial trial =
        run_trial(parsed(out.model), piles, TrialSees::kDepthAndIntensity, pool);
    out.self_test = judge(trial, geometry, DetectRequest{}.min_score);
    trials.self_test = out.self_test->record;
    out.advice = advice(*out.self_test, parsed(out.model));
    train::set_trials(out.model, trials);
    tell("self-test", 1);
  }
  return out;
}

}  // namespace binpick::app
