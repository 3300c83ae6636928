// What the machine can do, with the widest vectors it has: reads of whole vectors from each level
// of its memory. The benchmark read/LEVEL holds for sets of up to `capacity` bytes.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/kernels/machine_bench.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "bench/kernels/kernel_bench.hpp"

HWY_BEFORE_NAMESPACE();
namespace binpick::simd::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Eight loads at a time, so that none waits for another. `size` is a multiple of eight vectors.
void ReadAll(const std::uint8_t* bytes, std::size_t size) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t n = hn::Lanes(d);
  auto a = hn::Zero(d), b = a;
  for (std::size_t i = 0; i < size; i += 8 * n) {
    const std::uint8_t* at = bytes + i;
    a = hn::Or(a, hn::Or(hn::Or(hn::Load(d, at), hn::Load(d, at + n)),
                         hn::Or(hn::Load(d, at + 2 * n), hn::Load(d, at + 3 * n))));
    b = hn::Or(b, hn::Or(hn::Or(hn::Load(d, at + 4 * n), hn::Load(d, at + 5 * n)),
                         hn::Or(hn::Load(d, at + 6 * n), hn::Load(d, at + 7 * n))));
  }
  benchmark::DoNotOptimize(hn::GetLane(hn::Or(a, b)));
}

std::size_t VectorBytes() {
  return hn::Lanes(hn::ScalableTag<std::uint8_t>());
}

}  // namespace binpick::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <hwy/aligned_allocator.h>

#include <memory>

namespace binpick::simd {

HWY_EXPORT(ReadAll);
HWY_EXPORT(VectorBytes);

namespace {

void add_reads(const std::string& level, std::size_t size, double capacity) {
  const std::shared_ptr<std::uint8_t[]> bytes = hwy::AllocateAligned<std::uint8_t>(size);
  std::fill_n(bytes.get(), size, std::uint8_t{1});
  benchmark::RegisterBenchmark(("read/" + level).c_str(), [=](benchmark::State& state) {
    for ([[maybe_unused]] auto _ : state) HWY_DYNAMIC_DISPATCH(ReadAll)(bytes.get(), size);
    state.counters["bytes"] = static_cast<double>(size);
    state.counters["capacity"] = capacity;
    state.counters["vector_bytes"] = static_cast<double>(HWY_DYNAMIC_DISPATCH(VectorBytes)());
  });
}

}  // namespace

void add_machine_limits() {
  std::size_t largest = std::size_t{1} << 20;
  for (const benchmark::CPUInfo::CacheInfo& cache : benchmark::CPUInfo::Get().caches) {
    if (cache.type == "Instruction") continue;
    const auto size = static_cast<std::size_t>(cache.size);
    add_reads("L" + std::to_string(cache.level), size / 2, static_cast<double>(size));
    largest = std::max(largest, size);
  }
  add_reads("memory", 4 * largest, 1e18);
  // A multiplication, three cycles, and an addition, one, each of which waits for the other.
  benchmark::RegisterBenchmark("400_cycles", [](benchmark::State& state) {
    std::uint64_t x = 1;
    for ([[maybe_unused]] auto _ : state) {
      for (int i = 0; i < 100; ++i) x = x * 6364136223846793005u + 1442695040888963407u;
      benchmark::DoNotOptimize(x);
    }
  });
}

}  // namespace binpick::simd
#endif  // HWY_ONCE
