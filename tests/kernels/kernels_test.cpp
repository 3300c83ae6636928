// Every kernel on every vector unit of this machine against the scalar function, bit for bit.
#include <gtest/gtest.h>

#include <array>
#include <tuple>

#include "binpick/base/worker_pool.hpp"
#include "features/pyramid.hpp"
#include "kernel_inputs.hpp"
#include "simd/kernel_table.hpp"

namespace binpick::simd {
namespace {

constexpr int kSlack = 63;  // sums that scan_row may write beyond the last one
constexpr int kGuard = 70;
constexpr std::uint16_t kSentinel = 0xA5C3;
constexpr Isa kAllIsas[] = {Isa::kBest, Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512};

class Kernels : public testing::TestWithParam<Isa> {
 protected:
  void SetUp() override {
    if (!isa_supported(GetParam())) GTEST_SKIP() << "this machine has no " << isa_name(GetParam());
    table = make_kernel_table(GetParam());
  }
  KernelTable table{};
  std::mt19937 random{20240611};
};

std::vector<Feature> extreme_features(int count, std::uint8_t bits, std::uint8_t weight) {
  return std::vector<Feature>(static_cast<std::size_t>(count),
                              Feature{0, 0, bits, weight, bits, weight});
}

// Sums with the guarded room around them that scan_row writes to.
struct GuardedSums {
  GuardedSums(int width, int shift)
      : sums(static_cast<std::size_t>(kGuard + shift + width + kSlack + kGuard), kSentinel),
        first(sums.data() + kGuard + shift),
        written(width + kSlack) {}
  bool guards_intact() const {
    const auto is_sentinel = [](std::uint16_t v) { return v == kSentinel; };
    const std::uint16_t *begin = sums.data(), *end = begin + sums.size();
    return std::all_of(begin, begin + (first - begin), is_sentinel) &&
           std::all_of(begin + (first - begin) + written, end, is_sentinel);
  }
  std::vector<std::uint16_t> sums;
  std::uint16_t* first;
  int written;
};

void expect_same_scan(const KernelTable& table, const std::vector<std::uint8_t>& gradient,
                      const std::vector<std::uint8_t>& normal, std::ptrdiff_t row, int width,
                      const std::vector<ScanFeature>& features, int shift) {
  const PlainMaps maps{gradient.data() + shift, normal.data() + shift, 0};
  const int count = static_cast<int>(features.size());
  std::vector<std::uint16_t> g(static_cast<std::size_t>(width) + 1), n(g);
  search_kernels_scalar().scan_row(maps, row, width, features.data(), count, g.data(), n.data());
  GuardedSums g_vector(width, shift), n_vector(width, shift + 1);
  table.search.scan_row(maps, row, width, features.data(), count, g_vector.first, n_vector.first);
  const auto sums = static_cast<std::size_t>(width);
  ASSERT_EQ(0, std::memcmp(g.data(), g_vector.first, sums * sizeof(g[0]))) << width << ' ' << shift;
  ASSERT_EQ(0, std::memcmp(n.data(), n_vector.first, sums * sizeof(n[0]))) << width << ' ' << shift;
  ASSERT_TRUE(g_vector.guards_intact()) << width;
  ASSERT_TRUE(n_vector.guards_intact()) << width;
}

TEST_P(Kernels, ScanRowAgreesOnEverySizeAndStart) {
  constexpr int kBefore = 200;  // elements that negative offsets reach
  constexpr int kCounts[] = {0, 1, 7, 8, 9, 40, 255};
  for (int width = 0; width <= 2 * 64 + 1; ++width) {
    for (const int shift : {0, 1, 31}) {
      // No byte more than the contract allows to read: the sanitizers see what goes beyond.
      const auto size = static_cast<std::size_t>(shift + kBefore + width + kSlack);
      std::vector<std::uint8_t> gradient(size), normal(size);
      for (auto& b : gradient) b = random_byte(random);
      for (auto& b : normal) b = random_byte(random);
      std::vector<ScanFeature> features =
          scan_features(random_features(kCounts[width % 7], 12, random), 0);
      for (ScanFeature& f : features) f.offset = -static_cast<std::int32_t>(random() % kBefore);
      expect_same_scan(table, gradient, normal, kBefore, width, features, shift);
    }
  }
}

TEST_P(Kernels, ScanRowHoldsTheLargestSums) {
  const std::vector<std::uint8_t> full(300, 0xFF), empty(300, 0);
  const auto heavy = scan_features(extreme_features(255, 0xFF, 31), 0);
  expect_same_scan(table, full, full, 0, 129, heavy, 0);
  expect_same_scan(table, full, empty, 0, 129, heavy, 0);
  expect_same_scan(table, empty, full, 0, 129, heavy, 0);
  expect_same_scan(table, full, full, 0, 129, scan_features(extreme_features(255, 0, 31), 0), 0);
  GuardedSums g(10, 0), n(10, 0);
  table.search.scan_row({full.data(), full.data(), 0}, 0, 10, heavy.data(), 255, g.first, n.first);
  EXPECT_EQ(255 * 31, g.first[9]);
  EXPECT_EQ(255 * 31, n.first[9]);
}

// The sums with guards on both sides.
struct GuardedBlock {
  std::array<std::uint16_t, 16> before;
  BlockSums sums;
  std::array<std::uint16_t, 16> after;
  GuardedBlock() {
    before.fill(kSentinel);
    after.fill(kSentinel);
    std::memset(static_cast<void*>(&sums), 0xC3, sizeof(sums));
  }
  bool guards_intact() const {
    const auto is_sentinel = [](std::uint16_t v) { return v == kSentinel; };
    return std::all_of(before.begin(), before.end(), is_sentinel) &&
           std::all_of(after.begin(), after.end(), is_sentinel);
  }
};

bool same_sums(const BlockSums& a, const BlockSums& b) {
  return std::memcmp(a.gradient, b.gradient, sizeof(a.gradient)) == 0 &&
         std::memcmp(a.normal, b.normal, sizeof(a.normal)) == 0;
}

// Both layouts, by the table and by the specification, at one place.
void expect_same_block(const KernelTable& table, const PlainMaps& plain, const RearrangedMap& map,
                       int x, int y, const std::vector<Feature>& features, int scale_q8) {
  const int count = static_cast<int>(features.size());
  BlockSums expected;
  GuardedBlock specified, rearranged, by_rows;
  search_kernels_scalar().match_block_plain(plain, x, y, features.data(), count, scale_q8,
                                            expected);
  search_kernels_scalar().match_block_rearranged(map, x, y, features.data(), count, scale_q8,
                                                 specified.sums);
  table.search.match_block_rearranged(map, x, y, features.data(), count, scale_q8, rearranged.sums);
  table.search.match_block_plain(plain, x, y, features.data(), count, scale_q8, by_rows.sums);
  ASSERT_TRUE(same_sums(expected, specified.sums)) << x << ' ' << y << ' ' << count;
  ASSERT_TRUE(same_sums(expected, rearranged.sums)) << x << ' ' << y << ' ' << count;
  ASSERT_TRUE(same_sums(expected, by_rows.sums)) << x << ' ' << y << ' ' << count;
  ASSERT_TRUE(rearranged.guards_intact() && by_rows.guards_intact());
}

TEST_P(Kernels, BlocksAgreeInBothLayoutsAtEveryCount) {
  const KernelMaps maps(64, 48, 40, 180, random);
  for (int count = 0; count <= 2 * 64 + 1; ++count) {
    const int x = 2 * static_cast<int>(random() % 31), y = 2 * static_cast<int>(random() % 23);
    const auto features = random_features(count, 36, random);
    expect_same_block(table, maps.plain(), maps.rearranged(), x, y, features, 256);
  }
}

TEST_P(Kernels, BlocksAgreeAtOtherScales) {
  // Offsets of both signs, rounded by the scale, and a border that the largest scale fills.
  const KernelMaps maps(40, 40, 100, 200, random);
  for (const int scale_q8 : {77, 128, 181, 200, 255, 257, 300, 333, 362, 511, 639}) {
    for (int i = 0; i < 20; ++i) {
      const int x = 2 * static_cast<int>(random() % 19), y = 2 * static_cast<int>(random() % 19);
      const auto features = random_features(60, 36, random);
      expect_same_block(table, maps.plain(), maps.rearranged(), x, y, features, scale_q8);
    }
  }
}

TEST_P(Kernels, BlocksHoldTheLargestSums) {
  std::vector<std::uint8_t> full(64 * 64, 0xFF), blocks(64 * 64 * 8 + 32, 0xFF);
  std::uint8_t* aligned = blocks.data();
  while (reinterpret_cast<std::uintptr_t>(aligned) % 32 != 0) ++aligned;
  const auto heavy = extreme_features(255, 0xFF, 31);
  expect_same_block(table, {full.data(), full.data(), 64}, {aligned, 32}, 8, 8, heavy, 256);
  BlockSums sums;
  table.search.match_block_rearranged({aligned, 32}, 8, 8, heavy.data(), 255, 256, sums);
  EXPECT_EQ(255 * 31, sums.gradient[15]);
  EXPECT_EQ(255 * 31, sums.normal[0]);
}

TEST_P(Kernels, BlocksAgreeOnAPyramidOfRandomImages) {
  constexpr int kWidth = 96, kHeight = 64, kBorder = 24;
  std::vector<float> depth(kWidth * kHeight);
  std::vector<std::uint8_t> gray(depth.size());
  for (auto& z : depth) {
    z = random() % 8 == 0 ? 0.0f : 500.0f + static_cast<float>(random() % 1000) * 0.02f;
  }
  for (auto& g : gray) g = random_byte(random);
  Frame frame;
  frame.depth_mm = {depth.data(), kWidth, kHeight, kWidth};
  frame.intensity = {gray.data(), kWidth, kHeight, kWidth};
  frame.camera = {kWidth, kHeight, 600, 600, 48, 32};
  PyramidPlan plan{kWidth, kHeight, 3, kBorder, {true, true, true}};
  Arena arena(FeaturePyramid::footprint(plan));
  FeaturePyramid pyramid(plan, arena);
  SerialPool pool;
  pyramid.build(frame, {0, 0, kWidth, kHeight}, NormalCodebook::kHemisphere, table, pool);
  for (int l = 0; l < 3; ++l) {
    const PyramidLevel& level = pyramid.level(l);
    const auto features = random_features(50, kBorder - 4, random);
    int matched = 0;
    for (int y = 0; y + 4 <= level.height; y += 2) {
      for (int x = 0; x + 4 <= level.width; x += 2) {
        expect_same_block(table, level.plain, level.rearranged, x, y, features, 256);
        BlockSums sums;
        table.search.match_block_rearranged(level.rearranged, x, y, features.data(), 50, 256, sums);
        matched += sums.gradient[0] + sums.normal[0];
      }
    }
    EXPECT_GT(matched, 0) << "level " << l << " holds no features to compare";
  }
}

INSTANTIATE_TEST_SUITE_P(EachIsa, Kernels, testing::ValuesIn(kAllIsas),
                         [](const auto& unit) { return std::string(isa_name(unit.param)); });

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
