// Counts what is taken from the heap, apart by who takes it: code of the test program, into which
// the project's libraries are linked, or a shared library (Aravis, GLib, the C library). To be
// linked into the test program.
#pragma once

namespace binpick {

struct AllocationCounts {
  long long own = 0;     // by operator new anywhere but in shared libraries, or malloc and its like
  long long others = 0;  // by shared libraries
};

// False where a sanitizer holds malloc itself.
bool allocations_counted();
AllocationCounts allocations_of_this_thread();
AllocationCounts allocations_of_all_threads();

}  // namespace binpick
