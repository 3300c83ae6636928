// Runs a test on every vector unit of this machine.
#pragma once

#include <gtest/gtest.h>

#include <random>

#include "simd/kernel_table.hpp"

namespace binpick::simd {

inline constexpr Isa kAllIsas[] = {Isa::kBest, Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512};

class EachIsa : public testing::TestWithParam<Isa> {
 protected:
  void SetUp() override {
    if (!isa_supported(GetParam())) GTEST_SKIP() << "this machine has no " << isa_name(GetParam());
    table = make_kernel_table(GetParam());
  }
  KernelTable table{};
  std::mt19937 random{20240611};
};

inline std::string isa_of_test(const testing::TestParamInfo<Isa>& unit) {
  return isa_name(unit.param);
}

}  // namespace binpick::simd
