// Registers the kernels with Google Benchmark, each by the name KERNEL/ISA.
#pragma once

#include <benchmark/benchmark.h>

#include <string>

#include "simd/kernel_table.hpp"

namespace binpick::simd {

// Of a kernel that memory may bound: what one call moves to and from the memory in which its images
// lie, and how large those are. Zeros: the kernel computes.
struct Traffic {
  double bytes = 0, set_bytes = 0;
};

// `call` gets the number of the call, so that it may go to another place each time.
template <class Call>
void add_benchmark(const std::string& name, const Traffic& traffic, Call call) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) mutable {
    int i = 0;
    for ([[maybe_unused]] auto _ : state) {
      call(i++ & 0xFFFFF);
      benchmark::ClobberMemory();
    }
    state.counters["bytes"] = traffic.bytes;
    state.counters["set_bytes"] = traffic.set_bytes;
  });
}

void add_search_kernels(const KernelTable& table);
void add_feature_kernels(const KernelTable& table);
void add_pose_kernels(const KernelTable& table);
// What the machine can do: reads from each level of its memory, and the length of a cycle.
void add_machine_limits();

}  // namespace binpick::simd
