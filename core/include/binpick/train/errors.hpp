// Set-up errors of training: one sentence each, for the person who started it.
#pragma once

#include <stdexcept>

namespace binpick::train {

struct ImportError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
struct RenderError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
struct TrainError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace binpick::train
