// Counts what the whole program takes from the heap. To be linked into the test program.
#pragma once

namespace binpick {

// False where a sanitizer holds malloc itself.
bool allocations_counted();
long long allocation_count();

}  // namespace binpick
