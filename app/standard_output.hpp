// What is printed must not be lost in silence: a full disk behind `>` is an error like any other.
#pragma once

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>

namespace binpick::app {

// Throws std::runtime_error when something that was printed did not arrive.
inline void flush_standard_output() {
  const int error = std::fflush(stdout) == 0 ? 0 : errno;
  if (error == 0 && std::ferror(stdout) == 0) return;
  throw std::runtime_error("standard output: cannot be written" +
                           (error == 0 ? "" : std::string(": ") + std::strerror(error)));
}

}  // namespace binpick::app
