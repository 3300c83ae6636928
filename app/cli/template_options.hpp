// The options that say how templates are made, with the paper's defaults: of every command that
// trains.
#pragma once

#include <CLI/CLI.hpp>

#include "binpick/train/trainer.hpp"

namespace binpick::app {

// `options` lives as long as the command.
void add_template_options(CLI::App& command, train::TrainOptions& options);

}  // namespace binpick::app
