// Times each kernel on each vector unit of this machine, and the two layouts of the maps against
// each other. Prints a table; a test by itself it is not.
#include <chrono>
#include <cstdio>
#include <limits>

#include "kernel_inputs.hpp"

namespace binpick::simd {
namespace {

// As in a search: 90 features a template, a level of 640 x 512 pixels.
constexpr int kWidth = 640, kHeight = 512, kBorder = 64, kFeatures = 90;

// Shortest of many short runs, in ns a call: on a busy machine some of them are not interrupted.
template <class Call>
double time_ns(int calls, Call&& call) {
  double best = std::numeric_limits<double>::max();
  int next = 0;
  for (int run = 0; run < 500; ++run) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < calls; ++i) call(next + i);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
    best = std::min(best, took.count() / calls);
    next += calls;
  }
  return best;
}

// ns for each of kParents places: one template is matched at all of them at once.
template <int kParents, class Map, class Match>
double block_ns(const Map& map, const PlacedTemplate& t, Match&& match) {
  // As in a descent: the children of candidates at some places, then other places elsewhere.
  constexpr int kChildren = 16;
  BlockScores scores[kParents];
  return time_ns(100,
                 [&](int i) {
                   std::ptrdiff_t places[kParents];
                   for (int p = 0; p < kParents; ++p) {
                     const int at = i / kChildren + 7 * p;
                     places[p] = at * 37 % (kWidth / 2 - 2) * map.steps().x +
                                 at * 19 % (kHeight / 2 - 2) * map.steps().y;
                   }
                   match(map, places, kParents, t, scores);
                 }) /
         kParents;
}

void bench(const KernelTable& table, const KernelMaps& maps, const std::vector<Feature>& features) {
  const PlainMaps plain = maps.plain();
  const RearrangedMap& rearranged = maps.rearranged();
  auto on_plain = placed(features, plain.steps()), on_blocks = placed(features, rearranged.steps());
  const ScoreScale scale(1000, 1000);
  const PlacedTemplate by_rows{on_plain.data(), kFeatures, kFeatures, scale};
  const PlacedTemplate by_blocks{on_blocks.data(), kFeatures, kFeatures, scale};
  // Nothing improves, as nearly always in a scan.
  std::vector<std::uint16_t> known(kWidth / 2 + kReadAhead, UINT16_MAX);
  std::vector<CellScore> better(kWidth / 2);
  std::vector<std::uint8_t> bits(kWidth);
  const double scan = time_ns(10, [&](int i) {
    table.search.scan_cells(plain, i % (kHeight - 1) * plain.stride, kWidth / 2, by_rows,
                            known.data(), better.data());
  });
  const double place = time_ns(100, [&](int) {
    table.search.place_features(features.data(), kFeatures, 256, rearranged.steps(),
                                on_blocks.data());
  });
  const auto match_rows = table.search.match_blocks_plain;
  const auto match_blocks = table.search.match_blocks_rearranged;
  const double rows[] = {block_ns<1>(plain, by_rows, match_rows),
                         block_ns<2>(plain, by_rows, match_rows),
                         block_ns<4>(plain, by_rows, match_rows)};
  const double blocks[] = {block_ns<1>(rearranged, by_blocks, match_blocks),
                           block_ns<2>(rearranged, by_blocks, match_blocks),
                           block_ns<4>(rearranged, by_blocks, match_blocks)};
  const double gradient = time_ns(10, [&](int i) {
    table.features.gradient_row(plain.gradient + i % kHeight * plain.stride, plain.stride, kWidth,
                                1000, bits.data());
  });
  std::printf("%-8s %10.0f %10.0f %7.0f %7.0f %7.0f %7.0f %7.0f %7.0f %10.0f\n", table.name, scan,
              place, rows[0], rows[1], rows[2], blocks[0], blocks[1], blocks[2], gradient);
}

void run() {
  std::mt19937 random(7);
  const KernelMaps maps(kWidth, kHeight, kBorder, 128, random);
  const auto features = random_features(kFeatures, kBorder - 4, random);
  std::printf(
      "ns; %d features; two rows of %d px scanned; blocks of 4x4 px, ns for each of 1, 2 or "
      "4 that share a template\n",
      kFeatures, kWidth);
  std::printf("%-8s %10s %10s %23s %23s %10s\n", "isa", "scan", "placing", "plain 1, 2, 4",
              "rearranged 1, 2, 4", "gradient");
  for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (isa_supported(isa)) bench(make_kernel_table(isa), maps, features);
  }
}

}  // namespace
}  // namespace binpick::simd

int main() {
  binpick::simd::run();
}
