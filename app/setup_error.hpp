// What keeps a program from starting: an input that is missing or damaged, an output that cannot be
// written. One sentence that names the thing and the fault.
#pragma once

#include <stdexcept>

namespace binpick::app {

struct SetupError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace binpick::app
