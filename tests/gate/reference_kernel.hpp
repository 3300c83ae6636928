// Work of fixed size that a detector's time is compared with: about what detection does, over about
// as much memory, in plain code. It never changes, and nothing but the gate uses it: a faster
// detector is a smaller ratio.
#pragma once

#include <cstdint>
#include <vector>

namespace binpick {

class ReferenceKernel {
 public:
  ReferenceKernel();
  // Always the same number, so that the work cannot be left out.
  double run();

 private:
  void count_bits();    // as templates are matched: masks of bytes, counted
  double fit_planes();  // as poses are aligned: floats, divided and rooted

  std::vector<std::uint8_t> masks_, counts_;
  std::vector<float> depth_;
};

}  // namespace binpick
