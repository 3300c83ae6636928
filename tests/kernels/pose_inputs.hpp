// Random inputs for the pose kernels: samples, poses, depth with holes, and gray images.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "binpick/geometry/angle.hpp"
#include "binpick/geometry/pose.hpp"
#include "simd/pose_kernels.hpp"

namespace binpick::simd {

inline double uniform(double low, double high, std::mt19937& random) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
inline Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}
inline PoseF pose_of(const Mat3& R, const Vec3& t) {
  PoseF T{};
  for (int i = 0; i < 9; ++i) T.R[i] = static_cast<float>(R(i / 3, i % 3));
  for (int i = 0; i < 3; ++i) T.t[i] = static_cast<float>(t[i]);
  return T;
}

// Positions and unit directions, padded as in a model file and not by a float more.
class PoseSamples {
 public:
  explicit PoseSamples(int count)
      : count_(count), row_(padded_samples(static_cast<std::uint64_t>(count))), all_(6 * row_) {}
  // Spread over a ball.
  PoseSamples(int count, double radius_mm, std::mt19937& random) : PoseSamples(count) {
    for (int i = 0; i < count; ++i)
      set(i, uniform(0, radius_mm, random) * random_direction(random), random_direction(random));
  }
  void set(int i, const Vec3& p, const Vec3& d) {
    for (int k = 0; k < 3; ++k) {
      all_[static_cast<std::size_t>(k) * row_ + static_cast<std::size_t>(i)] =
          static_cast<float>(p[k]);
      all_[static_cast<std::size_t>(k + 3) * row_ + static_cast<std::size_t>(i)] =
          static_cast<float>(d[k]);
    }
  }
  SampleArrays arrays() const {
    const float* x = all_.data();
    return {count_, x, x + row_, x + 2 * row_, x + 3 * row_, x + 4 * row_, x + 5 * row_};
  }

 private:
  int count_;
  std::size_t row_;
  std::vector<float> all_;
};

inline PinholeF pinhole_of(double focal_px, int width, int height) {
  const auto f = static_cast<float>(focal_px);
  return {f,     f,    static_cast<float>(width - 1) / 2, static_cast<float>(height - 1) / 2,
          1 / f, 1 / f};
}

// Depth about a distance, with holes, steps and normals; no element more than a kernel may read.
class DepthImage {
 public:
  static constexpr int kWidth = 80, kHeight = 56, kStride = 83;
  static constexpr double kFocal_px = 100;

  DepthImage() : depth_(kSize, 0.0f), normal_x_(kSize), normal_y_(kSize), valid_(kSize + 3) {}
  DepthImage(double z_mm, double spread_mm, std::mt19937& random) : DepthImage() {
    for (std::size_t i = 0; i < kSize; ++i) {
      if (random() % 5 == 0) continue;
      const double step = random() % 4 == 0 ? 20 * spread_mm : spread_mm;
      depth_[i] = static_cast<float>(z_mm + uniform(-step, step, random));
      const Vec3 n = random_direction(random);
      normal_x_[i] = static_cast<float>(n.x());
      normal_y_[i] = static_cast<float>(n.y());
      valid_[i] = random() % 4 != 0;
    }
  }
  // `z_mm(u, v)` everywhere, without normals.
  template <class Depth>
  explicit DepthImage(Depth&& z_mm) : DepthImage() {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) depth_[index(u, v)] = static_cast<float>(z_mm(u, v));
    }
  }
  // Everywhere the same, in the frame of the pixel's ray.
  void set_normals(double x, double y) {
    std::fill(normal_x_.begin(), normal_x_.end(), static_cast<float>(x));
    std::fill(normal_y_.begin(), normal_y_.end(), static_cast<float>(y));
    std::fill(valid_.begin(), valid_.end(), std::uint8_t{1});
  }
  // Through the middle of a pixel; z is 1.
  static Vec3 ray(int u, int v) {
    const PinholeF c = pinhole_of(kFocal_px, kWidth, kHeight);
    return {(u - static_cast<double>(c.cx)) / kFocal_px,
            (v - static_cast<double>(c.cy)) / kFocal_px, 1};
  }
  DepthMap map() const {
    return {
        depth_.data(), normal_x_.data(), normal_y_.data(), valid_.data(),
        kWidth,        kHeight,          kStride,          pinhole_of(kFocal_px, kWidth, kHeight)};
  }

 private:
  static std::size_t index(int u, int v) { return static_cast<std::size_t>(v * kStride + u); }

  static constexpr std::size_t kSize = (kHeight - 1) * kStride + kWidth;
  std::vector<float> depth_, normal_x_, normal_y_;
  std::vector<std::uint8_t> valid_;
};

class GrayImage {
 public:
  static constexpr int kWidth = 160, kHeight = 112, kStride = 165;
  static constexpr double kFocal_px = 200;

  // `gray(u, v)`: 0..255.
  template <class Gray>
  explicit GrayImage(Gray&& gray) : pixels_((kHeight - 1) * kStride + kWidth + 3) {
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        pixels_[static_cast<std::size_t>(v * kStride + u)] =
            static_cast<std::uint8_t>(std::clamp(std::lround(gray(u, v)), 0L, 255L));
      }
    }
  }
  static GrayImage noise(std::mt19937& random) {
    return GrayImage([&](int, int) { return static_cast<double>(random() % 256); });
  }
  // Discs and stripes, blurred as a lens does, with a little noise.
  static GrayImage edges(std::mt19937& random) {
    return GrayImage([&](int u, int v) {
      const double disc = std::hypot(u - 70, v - 50) - 30,
                   stripe = 9 * std::sin(0.21 * u - 0.3 * v);
      return 90 + 60 * std::tanh(disc) + 35 * std::tanh(stripe) + uniform(-4, 4, random);
    });
  }
  GrayMap map() const {
    return {pixels_.data(), kWidth, kHeight, kStride, pinhole_of(kFocal_px, kWidth, kHeight)};
  }

 private:
  std::vector<std::uint8_t> pixels_;
};

// Most of a ball of samples in sight, some of it outside the image, some hidden.
inline PoseF pose_in_sight(std::mt19937& random) {
  const Mat3 R = rotation_from_vector(uniform(0, kPi, random) * random_direction(random));
  return pose_of(R,
                 {uniform(-60, 60, random), uniform(-50, 50, random), uniform(180, 220, random)});
}
// The camera stands inside the ball, or behind it.
inline PoseF pose_at_the_camera(std::mt19937& random) {
  PoseF T = pose_in_sight(random);
  T.t[2] = static_cast<float>(uniform(-60, 30, random));
  return T;
}

}  // namespace binpick::simd
