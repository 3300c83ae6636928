#include "training/part_training.hpp"

#include <stdexcept>

#include "binpick/detect/detector.hpp"
#include "error_text.hpp"
#include "training/near_symmetries.hpp"
#include "training/score_calibration.hpp"
#include "training/variance_scale.hpp"

namespace binpick::app {
namespace {

// Apart from each other, and from the seed of the templates' samples.
constexpr std::uint64_t kCalibrationSeed = 0x63616c6962726174;
constexpr std::uint64_t kTestSeed = 0x73656c6674657374;
// Poses of small parts have to be nearer than the limits of the bin-picking experiment.
constexpr double kLimitInDiameters = 0.075;
// Of the time that a step with piles takes: making them.
constexpr double kPilesShare = 0.5;

ObjectModel parsed(const std::vector<std::uint8_t>& bytes) {
  const Result<ObjectModel> model = ObjectModel::parse(bytes);
  if (!model.ok()) {
    throw std::runtime_error("the model just trained is not valid: " + error_text(model.error()));
  }
  return model.value();
}

// A stage's own progress as its share of the whole.
train::TrainProgress share_of(const train::TrainProgress& progress, double from, double to) {
  return [=](double done) { progress(from + (to - from) * done); };
}

PoseLimits limits_of(const ObjectModel& model) {
  PoseLimits limits;
  limits.mm = std::min(limits.mm, kLimitInDiameters * model.info().diameter_mm);
  return limits;
}

ScoreCalibration score_of(const PileTrial& trial, const PartGeometry& geometry,
                          const PoseLimits& limits) {
  const std::vector<bool> right = right_rows(trial, geometry, limits);
  std::vector<JudgedScore> poses;
  for (std::size_t i = 0; i < right.size(); ++i) poses.push_back({trial.rows[i].score, right[i]});
  return fit_calibration(poses);
}

// Marks what detection cannot tell, then fits scores and variances to what it then finds.
ModelTrials calibrate(std::vector<std::uint8_t>& model_bytes, const train::Mesh& mesh,
                      const std::vector<SimulatedPile>& piles, WorkerPool& pool,
                      const train::TrainProgress& progress) {
  ObjectModel model = parsed(model_bytes);
  const PoseLimits limits = limits_of(model);
  const auto trial_of = [&](Modality modality, int number) {
    return run_trial(model, piles, modality, pool,
                     share_of(progress, number / 4.0, (number + 1) / 4.0));
  };
  PileTrial both = trial_of(Modality::kDepthAndIntensity, 0);
  const train::NearSymmetries which = indistinguishable_symmetries(both, model, mesh, limits);
  if (which.any()) {  // and so detection goes otherwise from here on
    train::set_indistinguishable(model_bytes, which);
    model = parsed(model_bytes);
    both = trial_of(Modality::kDepthAndIntensity, 1);
  }
  const PartGeometry geometry = geometry_of(model, mesh);
  const PileTrial intensity = trial_of(Modality::kIntensity, 2);
  ModelTrials trials;
  trials.calibration_piles = static_cast<std::int32_t>(piles.size());
  trials.with_intensity = score_of(both, geometry, limits);
  trials.depth_alone = score_of(trial_of(Modality::kDepth, 3), geometry, limits);
  trials.intensity_alone = score_of(intensity, geometry, limits);
  const auto grow = [&](const PileTrial& trial, double& scale) {
    if (const auto growth = growth_of_variance(trial, geometry, model.centre_mm()))
      scale *= *growth;
  };
  grow(both, trials.variance_scale);
  grow(intensity, trials.variance_scale_intensity_alone);
  return trials;
}

}  // namespace

TrainedPart train_part(const train::ImportedMesh& part, const train::TrainOptions& options,
                       const TrialPlan& plan, WorkerPool& pool,
                       const PartTrainingProgress& progress) {
  const auto tell = [&](double share) {
    if (progress) progress("training", share);
  };
  tell(0);  // symmetries are looked for first, and tell nothing
  return try_part(train::train_model(part, options, pool, tell), part, options, plan, pool,
                  progress);
}

TrainedPart try_part(std::vector<std::uint8_t> model_bytes, const train::ImportedMesh& part,
                     const train::TrainOptions& options, const TrialPlan& plan, WorkerPool& pool,
                     const PartTrainingProgress& progress) {
  const auto tell = [&](const char* step, double share) {
    if (progress) progress(step, share);
  };
  TrainedPart out;
  out.model = std::move(model_bytes);
  if (plan.calibration_piles <= 0 && plan.test_piles <= 0) return out;

  const PileMaker maker(part, options, plan.sensor_kind);
  const auto progress_of = [&](const char* step) -> train::TrainProgress {
    return [&tell, step](double share) { tell(step, share); };
  };
  const auto piles_of = [&](const char* step, int count, std::uint64_t seed) {
    tell(step, 0);
    return maker.make(count, options.seed ^ seed, pool,
                      share_of(progress_of(step), 0, kPilesShare));
  };
  ModelTrials trials;
  if (plan.calibration_piles > 0) {
    const auto piles = piles_of("calibration", plan.calibration_piles, kCalibrationSeed);
    trials = calibrate(out.model, part.mesh, piles, pool,
                       share_of(progress_of("calibration"), kPilesShare, 1));
    train::set_trials(out.model, trials);
  }
  if (plan.test_piles > 0) {
    const auto piles = piles_of("self-test", plan.test_piles, kTestSeed);
    const ObjectModel model = parsed(out.model);
    const PileTrial trial = run_trial(model, piles, Modality::kDepthAndIntensity, pool,
                                      share_of(progress_of("self-test"), kPilesShare, 1));
    out.self_test = judge(trial, geometry_of(model, part.mesh), DetectRequest{}.min_score);
    out.advice = advice(*out.self_test, model);
    trials.self_test = out.self_test->record;
    train::set_trials(out.model, trials);
  }
  return out;
}

}  // namespace binpick::app
