// Seeded randomness that is the same on every machine: the distributions of the standard library
// differ between implementations, these do not. Also smooth noise as a function of position.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace binpick::simulation {

class Rng {
 public:
  explicit Rng(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next();
  double uniform();  // [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  int below(int count) { return static_cast<int>(uniform() * count); }
  double normal();
  // A generator of its own, so that drawing more from one does not shift the other.
  Rng fork(std::uint64_t tag) { return Rng(next() ^ (tag * 0x9e3779b97f4a7c15ull)); }

 private:
  std::uint64_t state_;
};

// Smooth noise in [0, 1] with features of about unit size.
float value_noise(const Eigen::Vector3f& p, std::uint32_t seed);
// Three octaves of it, still in [0, 1].
float fractal_noise(const Eigen::Vector3f& p, std::uint32_t seed);
// One random value in [0, 1] per irregular cell of about unit size.
float cell_noise(const Eigen::Vector3f& p, std::uint32_t seed);
// The same in the plane, for noise that belongs to image pixels.
float pixel_noise(float x, float y, std::uint32_t seed);

}  // namespace binpick::simulation
