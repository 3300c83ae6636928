// Counts what is taken from the heap, by thread and by who takes it. Linked into a test program, or
// loaded into any program by LD_PRELOAD: where BINPICK_ALLOCATIONS names a file, the table of
// threads below is kept in it, for others to read while the program runs.
#pragma once

#include <atomic>
#include <cstdint>

namespace binpick {

struct AllocationCounts {
  // By operator new anywhere but in shared libraries, or malloc and its like: code of the program,
  // into which the project's libraries are linked.
  long long own = 0;
  long long others = 0;  // by shared libraries: Aravis, GLib, OpenCV, the C and C++ libraries
};

// False where a sanitizer holds malloc itself.
bool allocations_counted();
// All threads, own and others.
long long allocation_count();
AllocationCounts allocations_of_this_thread();
AllocationCounts allocations_of_all_threads();

// One thread that ever allocated. The numbers only grow; what a thread that is gone has counted
// stays.
struct ThreadAllocations {
  std::atomic<std::int64_t> tid{0};  // 0: free
  std::atomic<std::int64_t> own{0}, others{0};
};
// The last entry is of all threads for which there was no room.
inline constexpr int kThreadsCounted = 256;

}  // namespace binpick
