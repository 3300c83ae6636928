// BINPICK_ASSERT: a programmer's error ends the process, in release builds too. Wrong input is
// never an assertion: it is a Result or, at start, an exception.
#pragma once

namespace binpick {

[[noreturn]] void assertion_failed(const char* expression, const char* file, int line);

}  // namespace binpick

#define BINPICK_ASSERT(expression)     \
  ((expression) ? static_cast<void>(0) \
                : ::binpick::assertion_failed(#expression, __FILE__, __LINE__))
