// The sentence that a person reads for an Error of core.
#pragma once

#include <string>

#include "binpick/base/result.hpp"

namespace binpick::app {

inline std::string error_text(const Error& error) {
  std::string text = error_message(error.code);
  if (error.code == ErrorCode::kFrameTooLarge && error.detail >> 16 != 0) {
    return text + ": " + std::to_string(error.detail >> 16) + "x" +
           std::to_string(error.detail & 0xFFFF) + " px";
  }
  if (*error.where != '\0') {
    text += std::string(" (") + error.where + ": " + std::to_string(error.detail) + ")";
  }
  return text;
}

}  // namespace binpick::app
