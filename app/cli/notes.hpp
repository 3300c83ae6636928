// What reading a file found out, for the person at the terminal.
#pragma once

#include <cstdio>
#include <span>
#include <string>

namespace binpick::app {

// Each on a line of its own on stderr.
inline void print_notes(std::span<const std::string> notes) {
  for (const std::string& note : notes) std::fprintf(stderr, "binpick: %s\n", note.c_str());
}

}  // namespace binpick::app
