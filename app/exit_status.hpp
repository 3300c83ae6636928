// The exit status and the sentence for what ends a program.
#pragma once

#include <exception>
#include <new>
#include <string>

#include "binpick/drivers/loaded_frame.hpp"
#include "config/config_file.hpp"
#include "exit_code.hpp"
#include "setup_error.hpp"

namespace binpick::app {

// Of what ends a program. An absent sensor is a failure: it may be there the next time.
inline ExitStatus status_of(const std::exception& e) {
  const bool of_input = dynamic_cast<const ConfigError*>(&e) != nullptr ||
                        dynamic_cast<const SetupError*>(&e) != nullptr ||
                        dynamic_cast<const drivers::DatasetError*>(&e) != nullptr;
  return of_input ? kCannotStart : kFailure;
}

inline std::string text_of(const std::exception& e) {
  return dynamic_cast<const std::bad_alloc*>(&e) != nullptr ? "out of memory" : e.what();
}

}  // namespace binpick::app
