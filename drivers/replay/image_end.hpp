// Whether an image file is whole. The decoder of JPEG fills what is missing with gray and calls
// that a success; that of PNG prints a complaint of its own.
#pragma once

#include <string>

namespace binpick::drivers {

// True for a file that begins as a JPEG or PNG and has not its end: it was cut short.
bool ends_too_early(const std::string& path);

}  // namespace binpick::drivers
