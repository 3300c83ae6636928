#include "simulation/random.hpp"

#include <cmath>

#include "binpick/geometry/angle.hpp"

namespace binpick::simulation {
namespace {

std::uint32_t mix(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
  std::uint32_t h = seed * 0x9e3779b1u;
  h = (h ^ static_cast<std::uint32_t>(x)) * 0x85ebca6bu;
  h = (h ^ (h >> 13) ^ static_cast<std::uint32_t>(y)) * 0xc2b2ae35u;
  h = (h ^ (h >> 16) ^ static_cast<std::uint32_t>(z)) * 0x27d4eb2fu;
  h ^= h >> 15;
  h *= 0x85ebca6bu;
  return h ^ (h >> 13);
}

float unit(std::uint32_t h) {
  return static_cast<float>(h >> 8) * (1.0f / 16777216.0f);
}

float smooth(float t) {
  return t * t * (3 - 2 * t);
}

}  // namespace

std::uint64_t Rng::next() {  // splitmix64
  state_ += 0x9e3779b97f4a7c15ull;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

double Rng::uniform() {
  return static_cast<double>(next() >> 11) * 0x1.0p-53;
}

double Rng::normal() {
  const double radius = std::sqrt(-2 * std::log(1.0 - uniform()));
  return radius * std::cos(2 * kPi * uniform());
}

float value_noise(const Eigen::Vector3f& p, std::uint32_t seed) {
  const Eigen::Vector3f base = p.array().floor();
  const int x = static_cast<int>(base.x());
  const int y = static_cast<int>(base.y());
  const int z = static_cast<int>(base.z());
  const float fx = smooth(p.x() - base.x());
  const float fy = smooth(p.y() - base.y());
  const float fz = smooth(p.z() - base.z());
  const auto edge = [&](int dy, int dz) {
    const float a = unit(mix(x, y + dy, z + dz, seed));
    const float b = unit(mix(x + 1, y + dy, z + dz, seed));
    return a + (b - a) * fx;
  };
  const float low = edge(0, 0) + (edge(1, 0) - edge(0, 0)) * fy;
  const float high = edge(0, 1) + (edge(1, 1) - edge(0, 1)) * fy;
  return low + (high - low) * fz;
}

float fractal_noise(const Eigen::Vector3f& p, std::uint32_t seed) {
  return (4 * value_noise(p, seed) + 2 * value_noise(2.1f * p, seed + 1) +
          value_noise(4.3f * p, seed + 2)) /
         7;
}

float cell_noise(const Eigen::Vector3f& p, std::uint32_t seed) {
  const Eigen::Vector3f base = p.array().floor();
  float distance_best = 1e9f;
  std::uint32_t hash_best = 0;
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector3f cell =
        base + Eigen::Vector3f(static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 % 3 - 1),
                               static_cast<float>(i / 9 - 1));
    const std::uint32_t h = mix(static_cast<int>(cell.x()), static_cast<int>(cell.y()),
                                static_cast<int>(cell.z()), seed);
    const Eigen::Vector3f offset(unit(h << 3), unit(h << 11), unit(h * 0x9e3779b1u));
    const float distance = (cell + offset - p).squaredNorm();
    if (distance < distance_best) {
      distance_best = distance;
      hash_best = h;
    }
  }
  return unit(hash_best * 0x85ebca6bu);
}

float pixel_noise(float x, float y, std::uint32_t seed) {
  return value_noise(Eigen::Vector3f(x, y, 0.5f), seed);
}

}  // namespace binpick::simulation
