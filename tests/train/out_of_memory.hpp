// What an import says when its reader runs out of memory.
#pragma once

namespace binpick::train {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// A sanitizer ends a process that runs out of memory before it can say so.
inline constexpr const char* kOutOfMemory = "its reader ended without a result";
#else
inline constexpr const char* kOutOfMemory = "MiB of memory";
#endif

}  // namespace binpick::train
