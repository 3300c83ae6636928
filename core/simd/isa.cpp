#include "binpick/simd/isa.hpp"

#include <hwy/highway.h>

#include "binpick/base/assert.hpp"
#include "simd/kernel_table.hpp"

namespace binpick {
namespace {

struct IsaEntry {
  Isa isa;
  const char* name;
  std::int64_t targets;  // Highway targets that count as this one, none for kBest and kScalar
};

constexpr IsaEntry kIsas[] = {
    {Isa::kBest, "best", 0},
    {Isa::kScalar, "scalar", 0},
    {Isa::kSse4, "sse4", HWY_SSE4},
    {Isa::kAvx2, "avx2", HWY_AVX2},
    {Isa::kAvx512, "avx512", HWY_AVX3 | HWY_AVX3_DL},
};

const IsaEntry& entry(Isa isa) {
  for (const IsaEntry& e : kIsas) {
    if (e.isa == isa) return e;
  }
  BINPICK_ASSERT(false);
}

std::int64_t usable(Isa isa) {
  return entry(isa).targets & hwy::SupportedTargets() & HWY_TARGETS;
}

}  // namespace

bool isa_from_name(std::string_view name, Isa& isa) {
  for (const IsaEntry& e : kIsas) {
    if (name == e.name) {
      isa = e.isa;
      return true;
    }
  }
  return false;
}

const char* isa_name(Isa isa) {
  return entry(isa).name;
}

bool isa_supported(Isa isa) {
  return isa == Isa::kBest || isa == Isa::kScalar || usable(isa) != 0;
}

namespace simd {

KernelTable make_kernel_table(Isa isa) {
  BINPICK_ASSERT(isa_supported(isa));
  if (isa == Isa::kBest) {
    for (const Isa wider : {Isa::kAvx512, Isa::kAvx2, Isa::kSse4}) {
      if (usable(wider) != 0) return make_kernel_table(wider);
    }
  }
  if (isa == Isa::kBest || isa == Isa::kScalar) {
    return {search_kernels_scalar(), feature_kernels_scalar(), pose_kernels_scalar(),
            isa_name(Isa::kScalar)};
  }
  hwy::ChosenTarget chosen;
  chosen.Update(usable(isa) & -usable(isa));  // the lowest bit is the widest unit
  const std::size_t target = chosen.GetIndex();
  return {search_kernels_vector(target), feature_kernels_vector(target),
          pose_kernels_vector(target), isa_name(isa)};
}

}  // namespace simd
}  // namespace binpick
