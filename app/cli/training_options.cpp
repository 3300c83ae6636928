#include "cli/training_options.hpp"

#include <string>
#include <vector>

#include "cli/model_summary.hpp"
#include "cli/number_between.hpp"

namespace binpick::app {
namespace {

constexpr NormalCodebook kCodebooks[] = {NormalCodebook::kHemisphere, NormalCodebook::kAzimuth};

void add_codebook_option(CLI::App& command, train::TrainOptions& options, const char* group) {
  std::vector<std::string> names;
  for (const NormalCodebook c : kCodebooks) names.emplace_back(codebook_name(c));
  const auto set = [&options](const std::string& name) {
    for (const NormalCodebook c : kCodebooks)
      if (name == codebook_name(c)) options.normal_codebook = c;
  };
  command
      .add_option_function<std::string>(
          "--normal-codebook", set,
          "How normals are quantized: hemisphere, or azimuth as in the paper")
      ->check(CLI::IsMember(names))
      ->default_str(codebook_name(options.normal_codebook))
      ->group(group);
}

}  // namespace

void add_template_options(CLI::App& command, train::TrainOptions& options) {
  const char* const group = "Templates (defaults are the paper's)";
  const auto add = [&]<class T>(const char* name, T& value, const char* what, T min, T max) {
    command.add_option(name, value, what)
        ->check(number_between(min, max))
        ->capture_default_str()
        ->group(group);
  };
  add("--samples", options.samples, "Randomized renderings a template", 10, 2500);
  add("--gradient-threshold", options.gradient_threshold,
      "Share of the samples that has to vote for a gradient orientation", 0.0, 0.999);
  add("--normal-threshold", options.normal_threshold,
      "Share of the samples that has to vote for a normal orientation", 0.0, 0.999);
  add("--tilt-jitter-deg", options.tilt_jitter_deg, "Samples tilt by up to this, +-", 0.0, 45.0);
  add("--roll-jitter-deg", options.roll_jitter_deg, "Samples roll by up to this, +-", 0.0, 45.0);
  add("--distance-jitter-mm", options.distance_jitter_mm, "Samples move by up to this, +-", 0.0,
      1e4);
  add("--roll-interval-deg", options.roll_interval_deg, "Roll from leaf to leaf", 1.0, 90.0);
  add("--distance-interval-mm", options.distance_interval_mm, "Distance from leaf to leaf, at most",
      1.0, 1e4);
  add("--tree-depths", options.tree_depths, "Depths of the pose tree: 4 end at 642 viewpoints", 1,
      4);
  add("--contour-features", options.contour_features,
      "Pixels of a template with a gradient orientation, at most", 1, 4096);
  add("--surface-features", options.surface_features,
      "Further pixels with a normal orientation only, at most", 0, 4096);
  add_codebook_option(command, options, group);
}

void add_trial_options(CLI::App& command, TrialPlan& plan, bool with_test) {
  const char* const group = "Simulated piles, after training";
  const auto add = [&](const char* name, int& value, const char* what) {
    command.add_option(name, value, what)
        ->check(number_between(0, 1000))
        ->capture_default_str()
        ->group(group);
  };
  add("--calibration-piles", plan.calibration_piles,
      "Piles that the score is calibrated with; 0: as the evidence has it");
  if (with_test) add("--test-piles", plan.test_piles, "Piles of the self-test; 0: none");
  command
      .add_option_function<std::string>(
          "--sensor-kind",
          [&plan](const std::string& name) { plan.sensor_kind = simulation::sensor_kind_of(name); },
          "Kind of sensor that sees them; all kinds in turn when left out")
      ->check(CLI::IsMember(simulation::sensor_kind_names()))
      ->group(group);
}

}  // namespace binpick::app
