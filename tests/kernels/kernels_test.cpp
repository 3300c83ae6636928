// What a kernel table is made for.
#include "each_isa.hpp"

namespace binpick::simd {
namespace {

TEST(Isa, NamesAreReadBack) {
  for (const Isa isa : kAllIsas) {
    Isa read = Isa::kBest;
    EXPECT_TRUE(isa_from_name(isa_name(isa), read));
    EXPECT_EQ(isa, read);
  }
  Isa untouched = Isa::kSse4;
  EXPECT_FALSE(isa_from_name("avx9", untouched));
  EXPECT_EQ(Isa::kSse4, untouched);
}

TEST(Isa, ScalarAndBestAreAlwaysThere) {
  EXPECT_TRUE(isa_supported(Isa::kBest));
  EXPECT_TRUE(isa_supported(Isa::kScalar));
  EXPECT_STREQ("scalar", make_kernel_table(Isa::kScalar).name);
}

}  // namespace
}  // namespace binpick::simd
