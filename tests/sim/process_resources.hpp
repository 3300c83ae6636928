// What a process holds, for tests that nothing is left behind.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
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

// Of 100 runs of `cycle`, after the first 20: until then the allocator takes what it will keep.
template <class Cycle>
void expect_a_hundred_leave_nothing(Cycle&& cycle) {
  for (int i = 0; i < 20; ++i) cycle();
  const int threads = entries_of("/proc/self/task"), descriptors = entries_of("/proc/self/fd");
  const long pages = resident_pages();
  for (int i = 0; i < 100; ++i) cycle();
  EXPECT_EQ(entries_of("/proc/self/task"), threads);
  EXPECT_EQ(entries_of("/proc/self/fd"), descriptors);
  const long grown_kib = (resident_pages() - pages) * (getpagesize() / 1024);
  std::printf("[ measured ] %ld KiB more after 100 starts\n", grown_kib);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(grown_kib, 1024);
#endif
}

}  // namespace binpick
