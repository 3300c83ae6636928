// All kernels for one vector unit. A table is made once, when a detector is set up, and handed
// down.
#pragma once

#include "binpick/simd/isa.hpp"
#include "simd/feature_kernels.hpp"
#include "simd/pose_kernels.hpp"
#include "simd/search_kernels.hpp"

namespace binpick::simd {

struct KernelTable {
  SearchKernels search;
  FeatureKernels features;
  PoseKernels pose;
  const char* name;  // of the vector unit in use
};

// `isa` must be supported by this machine.
KernelTable make_kernel_table(Isa isa);

}  // namespace binpick::simd
