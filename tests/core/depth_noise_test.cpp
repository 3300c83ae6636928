#include "features/depth_noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace binpick {
namespace {

constexpr int kWidth = 384, kHeight = 256;
constexpr double kFocal = 950;

// Planes and a half cylinder, as a camera sees them: three quarters of the image are flat.
double bench(int x, int y) {
  const double u = (x - kWidth / 2.0) / kFocal, v = (y - kHeight / 2.0) / kFocal;
  if (x < kWidth / 4) {
    const double across = std::fmod(std::fabs(u) * 700, 12.0) - 6;
    return 690 - std::sqrt(std::max(0.0, 36 - across * across));
  }
  return 700 / (1 + 0.4 * u - 0.3 * v);
}

struct Image {
  std::vector<float> depth_mm;
  ImageView<const float> view() const { return {depth_mm.data(), kWidth, kHeight, kWidth}; }
};

Image image_of(double sigma_mm, std::uint32_t seed) {
  std::mt19937 bits(seed);
  std::normal_distribution<double> normal(0, 1);
  Image image;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double z = bench(x, y);
      // As triangulation errs: in proportion to the square of the distance.
      image.depth_mm.push_back(
          static_cast<float>(z + sigma_mm * z * z / (700 * 700) * normal(bits)));
    }
  }
  return image;
}

DepthNoise noise_of(const Image& image, WorkerPool& pool) {
  std::vector<float> scratch(static_cast<std::size_t>(noise_scratch_size(kWidth, kHeight)));
  return estimate_depth_noise(image.view(), simd::feature_kernels_scalar(), scratch, pool);
}

TEST(DepthNoise, IsThatOfTheFrame) {
  SerialPool pool;
  for (const double sigma_mm : {0.1, 0.2, 0.5, 1.0}) {
    const DepthNoise noise = noise_of(image_of(sigma_mm, 7), pool);
    EXPECT_NEAR(DepthNoise::mm(noise.of_patches, 700), sigma_mm, 0.15 * sigma_mm);
    EXPECT_NEAR(DepthNoise::mm(noise.of_neighbours, 700), sigma_mm, 0.15 * sigma_mm);
  }
}

TEST(DepthNoise, SlantedPlanesAreNone) {
  SerialPool pool;
  const DepthNoise noise = noise_of(image_of(0, 7), pool);
  EXPECT_LT(DepthNoise::mm(noise.of_patches, 700), 0.002);
}

TEST(DepthNoise, StepsAndHolesAreNone) {
  SerialPool pool;
  Image image = image_of(0.2, 7);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      float& z = image.depth_mm[static_cast<std::size_t>(y * kWidth + x)];
      if ((x / 16 + y / 16) % 2 == 0) z -= 40;
      if (x % 19 == 0 || y % 23 == 0) z = 0;
    }
  }
  EXPECT_NEAR(DepthNoise::mm(noise_of(image, pool).of_patches, 690), 0.2, 0.04);
}

TEST(DepthNoise, IsUnknownWithoutDepth) {
  SerialPool pool;
  Image image = image_of(0.2, 7);
  std::fill(image.depth_mm.begin(), image.depth_mm.end(), 0.0f);
  const DepthNoise noise = noise_of(image, pool);
  EXPECT_EQ(noise.of_patches, 0);
  EXPECT_EQ(noise.of_neighbours, 0);
}

}  // namespace
}  // namespace binpick
