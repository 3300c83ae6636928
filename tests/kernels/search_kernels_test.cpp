// The search kernels on every vector unit of this machine against the scalar functions, bit for
// bit.
#include <tuple>

#include "binpick/base/worker_pool.hpp"
#include "each_isa.hpp"
#include "features/pyramid.hpp"
#include "kernel_inputs.hpp"

namespace binpick::simd {
namespace {

constexpr int kGuard = 70;
constexpr std::uint8_t kSentinel = 0xC3;

using SearchKernelsTest = EachIsa;

// `count` elements for a kernel to write, with guards around them.
template <class T>
struct Guarded {
  explicit Guarded(int count)
      : bytes((static_cast<std::size_t>(count) + 2 * kGuard) * sizeof(T), kSentinel),
        written(count) {}
  T* data() { return reinterpret_cast<T*>(bytes.data()) + kGuard; }
  bool guards_intact() const {
    const auto untouched = [](std::uint8_t b) { return b == kSentinel; };
    const auto first = bytes.begin() + kGuard * static_cast<int>(sizeof(T));
    return std::all_of(bytes.begin(), first, untouched) &&
           std::all_of(first + written * static_cast<int>(sizeof(T)), bytes.end(), untouched);
  }
  std::vector<std::uint8_t> bytes;
  int written;
};

std::vector<Feature> extreme_features(int count, std::uint8_t bits, std::uint8_t weight) {
  return std::vector<Feature>(static_cast<std::size_t>(count),
                              Feature{0, 0, bits, weight, bits, weight});
}

PlacedTemplate template_of(const std::vector<PlacedFeature>& features) {
  int gradient_sum = 0, normal_sum = 0;
  for (const PlacedFeature& f : features) {
    gradient_sum += f.gradient_weight;
    normal_sum += f.normal_weight;
  }
  const int count = static_cast<int>(features.size());
  return {features.data(), count, count, ScoreScale(gradient_sum, normal_sum)};
}

TEST_P(SearchKernelsTest, FeaturesArePlacedAlikeAtEveryCount) {
  for (int count = 0; count <= kTemplateFeaturesMax; count += count < 20 ? 1 : 47) {
    for (const int scale_q8 : {0, 77, 255, 256, 257, 362, 512, 32767}) {
      // No feature more than the kernel may read: the sanitizers see what goes beyond.
      std::vector<Feature> features = random_features(count, 126, random);
      for (Feature& f : features) f.x = static_cast<std::int8_t>(random_byte(random));
      for (const MapSteps steps : {MapSteps{2, 2 * 1472}, MapSteps{32, 736 * 32}}) {
        Guarded<PlacedFeature> expected(count), found(count);
        search_kernels_scalar().place_features(features.data(), count, scale_q8, steps,
                                               expected.data());
        table.search.place_features(features.data(), count, scale_q8, steps, found.data());
        ASSERT_EQ(expected.bytes, found.bytes) << count << " at " << scale_q8;
      }
    }
  }
}

// With what is known just below, at and above each cell's best score.
void expect_same_cells(const KernelTable& table, const PlainMaps& maps, std::ptrdiff_t row,
                       int cells, const PlacedTemplate& t) {
  const auto size = static_cast<std::size_t>(cells);
  std::vector<std::uint16_t> known(size + kReadAhead - 1);
  std::vector<CellScore> best(size), expected(size);
  const int scored =
      search_kernels_scalar().scan_cells(maps, row, cells, t, known.data(), best.data());
  for (int i = 0; i < scored; ++i) {
    const CellScore& b = best[static_cast<std::size_t>(i)];
    const int above[] = {-1, 0, 1, -b.score};
    known[b.cell] = static_cast<std::uint16_t>(b.score + above[(b.cell + b.score) % 4]);
  }
  const int count =
      search_kernels_scalar().scan_cells(maps, row, cells, t, known.data(), expected.data());
  Guarded<CellScore> found(cells);
  ASSERT_EQ(count, table.search.scan_cells(maps, row, cells, t, known.data(), found.data()));
  ASSERT_TRUE(found.guards_intact()) << cells;
  for (int i = 0; i < count; ++i) {
    const CellScore &e = expected[static_cast<std::size_t>(i)], &f = found.data()[i];
    ASSERT_EQ(std::tie(e.cell, e.score, e.pixel), std::tie(f.cell, f.score, f.pixel)) << cells;
  }
}

TEST_P(SearchKernelsTest, CellsAgreeAtEveryCountAndStart) {
  constexpr int kBefore = 200;  // elements that negative offsets reach
  constexpr int kCounts[] = {0, 1, 7, 8, 9, 40, 255};
  for (int cells = 0; cells <= 2 * 64 + 1; ++cells) {
    for (const int shift : {0, 1, 31}) {
      // No byte more than the contract allows to read: the sanitizers see what goes beyond.
      const std::ptrdiff_t stride = 2 * cells + 5;
      const auto size = static_cast<std::size_t>(shift + kBefore + stride + 2 * cells + 63);
      std::vector<std::uint8_t> gradient(size), normal(size);
      for (auto& b : gradient) b = random_byte(random) & random_byte(random);
      for (auto& b : normal) b = random_byte(random) & random_byte(random);
      auto features = placed(random_features(kCounts[cells % 7], 12, random), {0, 0});
      for (PlacedFeature& f : features) f.offset = -static_cast<std::int32_t>(random() % kBefore);
      PlacedTemplate t = template_of(features);
      t.with_gradient = t.count == 0 ? 0 : static_cast<int>(random() % features.size());
      for (int i = t.with_gradient; i < t.count; ++i)
        features[static_cast<std::size_t>(i)].gradient_bits = 0;
      expect_same_cells(table, {gradient.data() + shift, normal.data() + shift, stride}, kBefore,
                        cells, t);
    }
  }
}

TEST_P(SearchKernelsTest, CellsHoldTheLargestSums) {
  const std::vector<std::uint8_t> full(600, 0xFF), empty(600, 0);
  const auto heavy = placed(extreme_features(255, 0xFF, 31), {0, 0});
  const auto blind = placed(extreme_features(255, 0, 31), {0, 0});
  const PlacedTemplate t = template_of(heavy);
  expect_same_cells(table, {full.data(), full.data(), 200}, 0, 70, t);
  expect_same_cells(table, {full.data(), empty.data(), 200}, 0, 70, t);
  expect_same_cells(table, {empty.data(), full.data(), 200}, 0, 70, t);
  expect_same_cells(table, {full.data(), full.data(), 200}, 0, 70, template_of(blind));
  const std::vector<std::uint16_t> known(70 + kReadAhead);
  std::vector<CellScore> better(70);
  ASSERT_EQ(70, table.search.scan_cells({full.data(), full.data(), 200}, 0, 70, t, known.data(),
                                        better.data()));
  EXPECT_EQ(t.scale.score(255 * 31, 255 * 31), better[69].score);
}

TEST_P(SearchKernelsTest, ScoresAreExactForEverySumOfWeights) {
  const std::vector<std::uint8_t> full(300, 0xFF);
  auto features = placed(extreme_features(255, 0xFF, 31), {0, 0});
  for (std::size_t n = 1; n <= features.size(); ++n) {
    for (int i = 0; i < 20; ++i) {
      const PlacedTemplate t{
          features.data(), static_cast<int>(n), static_cast<int>(n),
          ScoreScale(1 + static_cast<int>(random() % 7905), 1 + static_cast<int>(random() % 7905))};
      expect_same_cells(table, {full.data(), full.data(), 64}, 0, 3, t);
    }
    features[n - 1].gradient_weight = static_cast<std::uint8_t>(random() % 32);
    features[n - 1].normal_weight = static_cast<std::uint8_t>(random() % 32);
  }
}

// Both layouts, by the table and by the specification, at some places.
void expect_same_blocks(const KernelTable& table, const PlainMaps& plain, const RearrangedMap& map,
                        const std::vector<std::pair<int, int>>& at,
                        const std::vector<Feature>& features, int scale_q8) {
  const auto by_rows = placed(features, plain.steps(), scale_q8);
  const auto by_blocks = placed(features, map.steps(), scale_q8);
  std::vector<std::ptrdiff_t> rows, blocks;
  for (const auto& [x, y] : at) {
    rows.push_back(y * plain.stride + x);
    blocks.push_back(x / 2 * map.steps().x + y / 2 * map.steps().y);
  }
  const int count = static_cast<int>(at.size());
  Guarded<BlockScores> expected(count), specified(count), of_rows(count), of_blocks(count);
  const SearchKernels specification = search_kernels_scalar();
  specification.match_blocks_plain(plain, rows.data(), count, template_of(by_rows),
                                   expected.data());
  specification.match_blocks_rearranged(map, blocks.data(), count, template_of(by_blocks),
                                        specified.data());
  table.search.match_blocks_plain(plain, rows.data(), count, template_of(by_rows), of_rows.data());
  table.search.match_blocks_rearranged(map, blocks.data(), count, template_of(by_blocks),
                                       of_blocks.data());
  ASSERT_EQ(expected.bytes, specified.bytes) << features.size() << " features, " << count;
  ASSERT_EQ(expected.bytes, of_rows.bytes) << features.size() << " features, " << count;
  ASSERT_EQ(expected.bytes, of_blocks.bytes) << features.size() << " features, " << count;
}

std::vector<std::pair<int, int>> random_places(int count, int width, int height,
                                               std::mt19937& random) {
  std::vector<std::pair<int, int>> places;
  const auto even = [&](int side) { return static_cast<int>(random() % (side / 2 - 1)) * 2; };
  for (int i = 0; i < count; ++i) places.emplace_back(even(width), even(height));
  return places;
}

TEST_P(SearchKernelsTest, BlocksAgreeInBothLayoutsAtEveryCount) {
  const KernelMaps maps(64, 48, 40, 180, random);
  for (int count = 0; count <= 2 * 64 + 1; ++count) {
    const auto places = random_places(count % 11, 64, 48, random);
    expect_same_blocks(table, maps.plain(), maps.rearranged(), places,
                       random_features(count, 36, random), 256);
  }
}

TEST_P(SearchKernelsTest, BlocksAgreeAtOtherScales) {
  // Offsets of both signs, rounded by the scale, and a border that the largest scale fills.
  const KernelMaps maps(40, 40, 100, 200, random);
  for (const int scale_q8 : {77, 128, 181, 200, 255, 257, 300, 333, 362, 511, 639}) {
    expect_same_blocks(table, maps.plain(), maps.rearranged(), random_places(20, 40, 40, random),
                       random_features(60, 36, random), scale_q8);
  }
}

TEST_P(SearchKernelsTest, BlocksHoldTheLargestSums) {
  const std::vector<std::uint8_t> full(64 * 64, 0xFF), blocks(64 * 64 * 8 + 32, 0xFF);
  const std::uint8_t* aligned = blocks.data();
  while (reinterpret_cast<std::uintptr_t>(aligned) % 32 != 0) ++aligned;
  const auto heavy = extreme_features(255, 0xFF, 31);
  expect_same_blocks(table, {full.data(), full.data(), 64}, {aligned, 32}, {{8, 8}}, heavy, 256);
  const auto features = placed(heavy, {0, 0});
  const PlacedTemplate t = template_of(features);
  const std::ptrdiff_t place = 0;
  BlockScores scores;
  table.search.match_blocks_rearranged({aligned, 32}, &place, 1, t, &scores);
  EXPECT_EQ(t.scale.score(255 * 31, 255 * 31), scores.pixels[15]);
  EXPECT_EQ(t.scale.score(255 * 31, 255 * 31), scores.best[0]);
}

TEST_P(SearchKernelsTest, BlocksAgreeOnAPyramidOfRandomImages) {
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
    std::vector<std::pair<int, int>> everywhere;
    for (int y = 0; y + 4 <= level.height; y += 2) {
      for (int x = 0; x + 4 <= level.width; x += 2) everywhere.emplace_back(x, y);
    }
    expect_same_blocks(table, level.plain, level.rearranged, everywhere, features, 256);
    const auto by_rows = placed(features, level.plain.steps());
    const std::ptrdiff_t middle = level.height / 2 * level.plain.stride + level.width / 2;
    BlockScores scores;
    table.search.match_blocks_plain(level.plain, &middle, 1, template_of(by_rows), &scores);
    EXPECT_GT(scores.best[0], 0) << "level " << l << " holds no features to compare";
  }
}

INSTANTIATE_TEST_SUITE_P(EachIsa, SearchKernelsTest, testing::ValuesIn(kAllIsas), isa_of_test);

}  // namespace
}  // namespace binpick::simd
