// What the programs' exit status tells a script and the service manager.
#pragma once

#include <exception>
#include <new>
#include <string>

#include "binpick/drivers/loaded_frame.hpp"
#include "config/config_file.hpp"
#include "setup_error.hpp"

namespace binpick::app {

// 78 is EX_CONFIG: trying again with the same input is useless, and the unit does not.
enum ExitStatus : int { kDone = 0, kFailure = 1, kUsage = 2, kCannotStart = 78 };

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
