// The options of training, of every command that trains.
#pragma once

#include <CLI/CLI.hpp>

#include "training/part_training.hpp"

namespace binpick::app {

// How templates are made; the defaults are the paper's. What is handed in lives as long as the
// command.
void add_template_options(CLI::App& command, train::TrainOptions& options);

// How many simulated piles a trained part is tried on.
void add_trial_options(CLI::App& command, TrialPlan& plan, bool with_test);

}  // namespace binpick::app
