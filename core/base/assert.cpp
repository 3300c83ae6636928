#include "binpick/base/assert.hpp"

#include <cstdio>
#include <cstdlib>

namespace binpick {

void assertion_failed(const char* expression, const char* file, int line) {
  std::fprintf(stderr, "binpick: assertion failed: %s (%s:%d)\n", expression, file, line);
  std::abort();
}

}  // namespace binpick
