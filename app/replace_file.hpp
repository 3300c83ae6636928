// Writing a file so that readers see the old content or the new, never a half: a temporary file in
// the same folder, renamed when it is complete. Thread: any.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace binpick::app {

// Throws SetupError when replace_file(path) could not work now: to be asked before long work.
void check_replaceable(const std::string& path);

// Throws SetupError and leaves the old file as it was.
void replace_file(const std::string& path, std::span<const std::uint8_t> bytes);

}  // namespace binpick::app
