// Every kernel on every vector unit of this machine, and what the machine itself can do. A program
// of Google Benchmark: --help lists its options.
#include "bench/kernels/kernel_bench.hpp"

int main(int argc, char** argv) {
  using namespace binpick;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  simd::add_machine_limits();
  for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (!isa_supported(isa)) continue;
    const simd::KernelTable table = simd::make_kernel_table(isa);
    simd::add_search_kernels(table);
    simd::add_feature_kernels(table);
    simd::add_pose_kernels(table);
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
