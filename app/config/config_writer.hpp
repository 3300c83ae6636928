// A configuration as it is in effect, written out as files that load_config() reads back to the
// same values: after a reload that took over a part only, no file says what that is. Set-up, and
// reloading on the main thread: it allocates.
#pragma once

#include <string>

#include "config/config.hpp"

namespace binpick::app {

// The main file; names of files as the configuration holds them.
std::string written_config(const Config& config);
// A recipe file.
std::string written_recipe(const RecipeConfig& recipe);

}  // namespace binpick::app
