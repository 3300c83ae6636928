// Times each kernel on each vector unit of this machine, and the two layouts of the maps against
// each other. Prints a table; a test by itself it is not.
#include <chrono>
#include <cstdio>
#include <limits>

#include "kernel_inputs.hpp"

namespace binpick::simd {
namespace {

// As in a search: 60 features a template, a level of 640 x 512 pixels.
constexpr int kWidth = 640, kHeight = 512, kBorder = 64, kFeatures = 60;

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

void bench(const KernelTable& table, const KernelMaps& maps, const std::vector<Feature>& features) {
  const auto scanned = scan_features(features, maps.plain().stride);
  std::vector<std::uint16_t> g(kWidth + 64), n(kWidth + 64);
  std::vector<std::uint8_t> bits(kWidth);
  BlockSums sums;
  // As in a descent: the children of a candidate at one place, then another place somewhere else.
  constexpr int kChildren = 16;
  const auto x_of = [](int i) { return i / kChildren * 74 % (kWidth - 4) / 2 * 2; };
  const auto y_of = [](int i) { return i / kChildren * 38 % (kHeight - 4) / 2 * 2; };
  const double scan = time_ns(10, [&](int i) {
    table.search.scan_row(maps.plain(), i % kHeight * maps.plain().stride, kWidth, scanned.data(),
                          kFeatures, g.data(), n.data());
  });
  const double rearranged = time_ns(100, [&](int i) {
    table.search.match_block_rearranged(maps.rearranged(), x_of(i), y_of(i), features.data(),
                                        kFeatures, 256, sums);
  });
  const double plain = time_ns(100, [&](int i) {
    table.search.match_block_plain(maps.plain(), x_of(i), y_of(i), features.data(), kFeatures, 256,
                                   sums);
  });
  const double gradient = time_ns(10, [&](int i) {
    table.features.gradient_row(maps.plain().gradient + i % kHeight * maps.plain().stride,
                                maps.plain().stride, kWidth, 1000, bits.data());
  });
  std::printf("%-8s %12.0f %12.0f %12.0f %12.1f %12.0f\n", table.name, scan, plain, rearranged,
              plain / rearranged, gradient);
}

void run() {
  std::mt19937 random(7);
  const KernelMaps maps(kWidth, kHeight, kBorder, 128, random);
  const auto features = random_features(kFeatures, kBorder - 4, random);
  std::printf("ns a call; %d features; rows of %d px, blocks of 4 x 4 px\n", kFeatures, kWidth);
  std::printf("%-8s %12s %12s %12s %12s %12s\n", "isa", "scan row", "block plain", "rearranged",
              "plain/rearr.", "gradient row");
  for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (isa_supported(isa)) bench(make_kernel_table(isa), maps, features);
  }
}

}  // namespace
}  // namespace binpick::simd

int main() {
  binpick::simd::run();
}
