#include "features/pyramid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace binpick {
namespace {

constexpr int kWidth = 96, kHeight = 64, kLevels = 4, kBorder = 8;
constexpr Roi kWhole{0, 0, kWidth, kHeight};

// Slanted blocks before a wall, with noise and holes.
struct Picture {
  Picture() {
    std::mt19937 random(5);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const bool block = x / 12 % 2 == 0 && y / 10 % 2 == 0;
        const float noise = static_cast<float>(random() % 100) * 1e-3f;
        const float slope = 0.3f * static_cast<float>(x % 12) - 0.2f * static_cast<float>(y % 10);
        depth_mm.push_back(random() % 16 == 0 ? 0 : (block ? 600 + slope : 650) + noise);
        gray.push_back(static_cast<std::uint8_t>((block ? 160 : 60) + random() % 20));
      }
    }
  }
  Frame frame() const {
    Frame out;
    out.depth_mm = {depth_mm.data(), kWidth, kHeight, kWidth};
    out.intensity = {gray.data(), kWidth, kHeight, kWidth};
    out.camera = {kWidth, kHeight, 700, 700, 48, 32};
    return out;
  }
  std::vector<float> depth_mm;
  std::vector<std::uint8_t> gray;
};

// Its last task first: no task may depend on another.
class BackwardPool final : public WorkerPool {
 public:
  int thread_count() const override { return 1; }

 protected:
  void run(int count, TaskFn fn, void* context) override {
    for (int i = count - 1; i >= 0; --i) fn(context, i, 0);
  }
};

struct Built {
  Built() : arena(FeaturePyramid::footprint(plan)), pyramid(plan, arena) {}
  void build(const Roi& region, int finest_map = 0, Isa isa = Isa::kBest) {
    pyramid.build(picture.frame(), region, NormalCodebook::kHemisphere,
                  simd::make_kernel_table(isa), pool, finest_map);
  }

  Picture picture;
  PyramidPlan plan{kWidth, kHeight, kLevels, kBorder, {true, true, true, false}};
  Arena arena;
  FeaturePyramid pyramid;
  BackwardPool pool;
};

// All bytes of a level that the search sees: maps with their borders, blocks, depth.
std::vector<std::uint8_t> bytes_of(const PyramidLevel& level) {
  std::vector<std::uint8_t> out;
  const auto add = [&](const void* data, int count) {
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    out.insert(out.end(), bytes, bytes + count);
  };
  const int border = level.border;
  for (int y = -border; y < level.height + border; ++y) {
    const std::ptrdiff_t at = y * level.plain.stride - border;
    add(level.plain.gradient + at, level.width + 2 * border);
    add(level.plain.normal + at, level.width + 2 * border);
  }
  for (int y = 0; y < level.height; ++y)
    add(level.depth_mm + y * level.stride, level.width * static_cast<int>(sizeof(float)));
  if (!level.rearranged.blocks) return out;
  for (int r = -border / 2; r < (level.height + border) / 2; ++r) {
    add(level.rearranged.blocks +
            (r * level.rearranged.stride_blocks - border / 2) * simd::kBlockBytes,
        (level.width + 2 * border) / 2 * simd::kBlockBytes);
  }
  return out;
}

void expect_same_levels(const FeaturePyramid& a, const FeaturePyramid& b, int finest) {
  for (int l = finest; l < kLevels; ++l) {
    EXPECT_TRUE(bytes_of(a.level(l)) == bytes_of(b.level(l))) << "level " << l;
    EXPECT_TRUE(std::ranges::any_of(bytes_of(a.level(l)), [](auto byte) { return byte != 0; }));
  }
}

TEST(FeaturePyramid, HasTheSameBitsInAnyOrderOfTasksOnEveryVectorUnit) {
  Built expected;
  SerialPool serial;
  expected.pyramid.build(expected.picture.frame(), kWhole, NormalCodebook::kHemisphere,
                         simd::make_kernel_table(Isa::kScalar), serial);
  for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (!isa_supported(isa)) continue;
    Built built;
    built.build(kWhole, 0, isa);
    expect_same_levels(expected.pyramid, built.pyramid, 0);
  }
}

TEST(FeaturePyramid, KeepsNothingOfTheRegionsBefore) {
  Built used;
  used.build(kWhole);
  const Roi small{16, 8, 48, 40}, beyond{56, 32, 48, 40};
  for (const Roi& region : {small, beyond, kWhole}) {
    used.build(region);
    Built unused;
    unused.build(region);
    expect_same_levels(unused.pyramid, used.pyramid, 0);
  }
}

TEST(FeaturePyramid, IsTheSameFromTheFinestMapOn) {
  Built all;
  all.build({16, 8, 48, 40});
  for (int finest = 1; finest < kLevels; ++finest) {
    Built some;
    some.build(kWhole, finest - 1);
    some.build({16, 8, 48, 40}, finest);
    expect_same_levels(all.pyramid, some.pyramid, finest);
    // And back: what was left out before is not stale.
    some.build({16, 8, 48, 40}, 0);
    expect_same_levels(all.pyramid, some.pyramid, 0);
  }
}

TEST(FeaturePyramid, RearrangesItsMaps) {
  Built built;
  built.build(kWhole);
  for (int l = 0; l + 1 < kLevels; ++l) {
    const PyramidLevel& level = built.pyramid.level(l);
    for (int y = -kBorder; y + 4 <= level.height + kBorder; y += 2) {
      for (int x = -kBorder; x + 4 <= level.width + kBorder; x += 2) {
        const std::uint8_t* block =
            level.rearranged.blocks +
            (y / 2 * level.rearranged.stride_blocks + x / 2) * simd::kBlockBytes;
        for (int k = 0; k < 4; ++k) {
          const std::ptrdiff_t at = (y + k) * level.plain.stride + x;
          ASSERT_EQ(0, std::memcmp(block + 4 * k, level.plain.gradient + at, 4));
          ASSERT_EQ(0, std::memcmp(block + 16 + 4 * k, level.plain.normal + at, 4));
        }
      }
    }
  }
}

TEST(FeaturePyramid, CarriesFeaturesToOtherLevels) {
  Built built;
  built.build(kWhole);
  const FeaturePyramid& pyramid = built.pyramid;
  const auto gradient = [&](int l, int x, int y) {
    const simd::PlainMaps& maps = pyramid.level(l).plain;
    return maps.gradient[y * maps.stride + x];
  };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      EXPECT_EQ(gradient(1, x / 2, y / 2), gradient(0, x, y));
      const simd::PlainMaps &fine = pyramid.level(0).plain, &from = pyramid.level(1).plain;
      const bool measured = pyramid.level(0).depth_mm[y * pyramid.level(0).stride + x] > 0;
      EXPECT_EQ(measured ? from.normal[y / 2 * from.stride + x / 2] : 0,
                fine.normal[y * fine.stride + x]);
    }
  }
  for (int l = 2; l < kLevels; ++l) {
    for (int y = 0; y < kHeight >> l; ++y) {
      for (int x = 0; x < kWidth >> l; ++x) {
        EXPECT_EQ(gradient(l - 1, 2 * x, 2 * y) | gradient(l - 1, 2 * x + 1, 2 * y) |
                      gradient(l - 1, 2 * x, 2 * y + 1) | gradient(l - 1, 2 * x + 1, 2 * y + 1),
                  gradient(l, x, y));
      }
    }
  }
}

TEST(FeaturePyramid, TakesWhatIsNoDepthForMissing) {
  Built built;
  const float none[] = {-1, std::numeric_limits<float>::quiet_NaN(),
                        std::numeric_limits<float>::infinity(), 1e-30f, 2e6f};
  for (std::size_t i = 0; i < 5; ++i) built.picture.depth_mm[7 * i] = none[i];
  built.build(kWhole);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(0, built.pyramid.level(0).depth_mm[7 * i]) << i;
}

}  // namespace
}  // namespace binpick
