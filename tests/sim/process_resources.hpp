// What a process holds, for tests that nothing is left behind.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

namespace binpick {

// Of "/proc/self/task": threads; of "/proc/self/fd": descriptors.
inline int entries_of(const char* folder) {
  const std::filesystem::directory_iterator entries(folder);
  return static_cast<int>(std::distance(begin(entries), end(entries)));
}

// Of this process, once they are as few as `expected`, or after a second: the kernel lists a thread
// for a moment after it was joined.
inline int threads_at_last(int expected) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  int threads = entries_of("/proc/self/task");
  while (threads > expected && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    threads = entries_of("/proc/self/task");
  }
  return threads;
}

inline long resident_pages() {
  std::ifstream statm("/proc/self/statm");
  long size = 0, resident = 0;
  statm >> size >> resident;
  return resident;
}

// Of 100 runs of `cycle`, after the first 20: until then the allocator takes what it will keep. On
// a busy machine it may take another arena later, once; what is left behind grows in both halves.
template <class Cycle>
void expect_a_hundred_leave_nothing(Cycle&& cycle) {
  for (int i = 0; i < 20; ++i) cycle();
  const int threads = entries_of("/proc/self/task"), descriptors = entries_of("/proc/self/fd");
  const auto grown_kib_in_fifty = [&] {
    const long pages = resident_pages();
    for (int i = 0; i < 50; ++i) cycle();
    return (resident_pages() - pages) * (getpagesize() / 1024);
  };
  const long first_kib = grown_kib_in_fifty(), second_kib = grown_kib_in_fifty();
  EXPECT_EQ(entries_of("/proc/self/task"), threads);
  EXPECT_EQ(entries_of("/proc/self/fd"), descriptors);
  std::printf("[ measured ] %ld KiB more after 50 starts, %ld after 50 others\n", first_kib,
              second_kib);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(std::min(first_kib, second_kib), 512);
#endif
}

}  // namespace binpick
