// Random numbers that depend on a seed alone, never on the order or the thread in which they are
// asked for (splitmix64).
#pragma once

#include <cstdint>

namespace binpick::train {

inline constexpr std::uint64_t kSplitmixStep = 0x9E3779B97F4A7C15ull;

inline std::uint64_t mixed_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

// In [0, 1).
inline double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

// The index-th number of a seed.
inline double hashed_uniform(std::uint64_t seed, std::uint64_t index) {
  return unit_interval(mixed_bits(seed * kSplitmixStep + index + 0x632BE59BD9B4E019ull));
}

// One number after the other.
struct RandomSequence {
  std::uint64_t state;
  std::uint64_t next() { return mixed_bits(state += kSplitmixStep); }
  double uniform() { return unit_interval(next()); }
};

}  // namespace binpick::train
