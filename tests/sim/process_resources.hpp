// What a process holds, for tests that nothing is left behind.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>

namespace binpick {

// Of "/proc/self/task": threads; of "/proc/self/fd": descriptors.
inline int entries_of(const char* folder) {
  const std::filesystem::directory_iterator entries(folder);
  return static_cast<int>(std::distance(begin(entries), end(entries)));
}

inline long resident_pages() {
  std::ifstream statm("/proc/self/statm");
  long size = 0, resident = 0;
  statm >> size >> resident;
  return resident;
}

}  // namespace binpick
