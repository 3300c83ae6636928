// Between the table and the vector source: the functions compiled for one vector unit.
#pragma once

#include "simd/kernels.hpp"

namespace binpick::simd {

// `target_index`: position in Highway's dispatch tables.
KernelTable vector_kernels(std::size_t target_index);

}  // namespace binpick::simd
