// The kernels of the feature pyramid on every vector unit of this machine against the scalar
// functions, bit for bit, and what the scalar functions make of a few plain inputs.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "kernel_inputs.hpp"
#include "simd/kernel_table.hpp"
#include "simd/surface_slope.hpp"

namespace binpick::simd {
namespace {

constexpr int kGuard = 70;
constexpr std::uint8_t kSentinel = 0xC3;
constexpr Isa kAllIsas[] = {Isa::kBest, Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512};
// Twice the widest vector of floats and one, and the rim that the widest neighbourhood has.
constexpr int kWidthMax = 2 * 16 + 1 + 4;

class FeatureKernelsOf : public testing::TestWithParam<Isa> {
 protected:
  void SetUp() override {
    if (!isa_supported(GetParam())) GTEST_SKIP() << "this machine has no " << isa_name(GetParam());
    kernels = make_kernel_table(GetParam()).features;
  }
  FeatureKernels kernels{};
  const FeatureKernels specified = feature_kernels_scalar();
  std::mt19937 random{20240611};
};

// Room for a row, at any alignment, with guards on both sides.
template <class T>
struct GuardedRow {
  GuardedRow(int width, int shift)
      : bytes((static_cast<std::size_t>(shift + width) + 2 * kGuard) * sizeof(T), kSentinel),
        first(reinterpret_cast<T*>(bytes.data()) + kGuard + shift) {}
  std::vector<std::uint8_t> bytes;
  T* first;
};

struct GuardedNormals {
  GuardedNormals(int width, int shift)
      : x(width, shift), y(width, shift + 1), valid(width, shift + 2) {}
  NormalRow row() { return {x.first, y.first, valid.first}; }
  bool operator==(const GuardedNormals& other) const {
    return x.bytes == other.x.bytes && y.bytes == other.y.bytes && valid.bytes == other.valid.bytes;
  }
  GuardedRow<float> x, y;
  GuardedRow<std::uint8_t> valid;
};

// How many of 256 pixels are measured.
constexpr unsigned kMeasured[] = {0, 128, 240, 256};

// Slanted surfaces with noise and steps, and what single precision ends at; not a pixel more than
// its rows have: the sanitizers see what goes beyond.
struct DepthImage {
  DepthImage(int width, int height, int shift, unsigned measured, std::mt19937& random)
      : pixels(static_cast<std::size_t>(shift + (height - 1) * (width + 3) + width)),
        view{pixels.data() + shift, width, height, width + 3} {
    for (float& z : pixels) {
      const auto i = static_cast<int>(&z - pixels.data());
      const float noise = static_cast<float>(random() % 1000) * 2e-3f;
      z = 600 + 0.7f * static_cast<float>(i % (width + 3)) + noise;
      if (i / 5 % 4 == 0) z += 30;
      if (random() % 40 == 0) z = random() % 2 == 0 ? kDepthMin_mm : 0.9f * kDepthMax_mm;
      if ((random() & 0xFF) >= measured) z = 0;
    }
  }
  std::vector<float> pixels;
  ImageView<const float> view;
};

template <class Test>
void on_all_depth_images(int height, std::mt19937& random, Test&& test) {
  for (int width = 0; width <= kWidthMax; ++width) {
    for (const int shift : {0, 1, 5}) {
      for (const unsigned measured : kMeasured) {
        SCOPED_TRACE(testing::Message() << "width " << width << ", shift " << shift << ", measured "
                                        << measured << "/256");
        test(DepthImage(width, height, shift, measured, random).view, shift);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

TEST_P(FeatureKernelsOf, HalveRowAgrees) {
  for (int width = 0; width <= kWidthMax; ++width) {
    for (const int shift : {0, 1, 5}) {
      for (const unsigned measured : kMeasured) {
        const DepthImage image(2 * width, 2, shift, measured, random);
        GuardedRow<float> expected(width, shift), found(width, shift);
        specified.halve_row(image.view.data, image.view.stride, width, expected.first);
        kernels.halve_row(image.view.data, image.view.stride, width, found.first);
        ASSERT_EQ(expected.bytes, found.bytes) << width << ' ' << shift << ' ' << measured;
      }
    }
  }
}

TEST_P(FeatureKernelsOf, StepRowAgrees) {
  for (const float noise : {0.0f, 2e-6f}) {
    on_all_depth_images(3, random, [&](const ImageView<const float>& depth, int shift) {
      GuardedRow<std::uint8_t> expected(depth.width, shift), found(depth.width, shift);
      specified.step_row(depth, 1, noise, expected.first);
      kernels.step_row(depth, 1, noise, found.first);
      ASSERT_EQ(expected.bytes, found.bytes);
    });
  }
}

TEST_P(FeatureKernelsOf, FitRowAgrees) {
  const CameraIntrinsics camera{64, 64, 950, 940, -200.3, 30.6};
  on_all_depth_images(5, random, [&](const ImageView<const float>& depth, int shift) {
    GuardedNormals expected(depth.width, shift), found(depth.width, shift);
    specified.fit_row(depth, camera, 2, expected.row());
    kernels.fit_row(depth, camera, 2, found.row());
    ASSERT_TRUE(expected == found);
  });
}

// `valid` of 256 normals; the others are 0.
void fill_normals(std::vector<float>& x, std::vector<float>& y, std::vector<std::uint8_t>& flags,
                  unsigned valid, std::mt19937& random) {
  for (std::size_t i = 0; i < flags.size(); ++i) {
    flags[i] = (random() & 0xFF) < valid;
    const auto component = [&] {
      return flags[i] ? static_cast<float>(random() % 1401) * 1e-3f - 0.7f : 0.0f;
    };
    x[i] = component();
    y[i] = component();
  }
}

TEST_P(FeatureKernelsOf, PoolRowAgrees) {
  for (int width = 0; width <= kWidthMax; ++width) {
    for (const int shift : {0, 1, 5}) {
      for (const unsigned valid : kMeasured) {
        const std::ptrdiff_t stride = 2 * width + 1;
        const auto size = static_cast<std::size_t>(shift + stride + 2 * width);
        std::vector<float> x(size), y(size);
        std::vector<std::uint8_t> flags(size);
        fill_normals(x, y, flags, valid, random);
        const NormalRow from{x.data() + shift, y.data() + shift, flags.data() + shift};
        GuardedNormals expected(width, shift), found(width, shift);
        specified.pool_row(from, stride, width, expected.row());
        kernels.pool_row(from, stride, width, found.row());
        ASSERT_TRUE(expected == found) << width << ' ' << shift << ' ' << valid;
      }
    }
  }
}

TEST_P(FeatureKernelsOf, NormalBitsRowAgrees) {
  for (const NormalCodebook codebook : {NormalCodebook::kAzimuth, NormalCodebook::kHemisphere}) {
    for (int width = 0; width <= kWidthMax; ++width) {
      for (const unsigned valid : kMeasured) {
        const int shift = static_cast<int>(random() % 4);
        const auto size = static_cast<std::size_t>(shift + width);
        std::vector<float> x(size), y(size);
        std::vector<std::uint8_t> flags(size);
        fill_normals(x, y, flags, valid, random);
        for (std::size_t i = 0; i + 3 < size; i += 4) y[i] = x[i];  // on a boundary
        const NormalRow from{x.data() + shift, y.data() + shift, flags.data() + shift};
        GuardedRow<std::uint8_t> expected(width, shift), found(width, shift);
        specified.normal_bits_row(codebook, from, width, expected.first);
        kernels.normal_bits_row(codebook, from, width, found.first);
        ASSERT_EQ(expected.bytes, found.bytes) << width << ' ' << valid;
      }
    }
  }
}

TEST_P(FeatureKernelsOf, RoughnessAgrees) {
  for (int width = kNoiseTilePx; width <= 2 * kNoiseTilePx + 5; ++width) {
    for (const unsigned measured : kMeasured) {
      const int shift = static_cast<int>(random() % 4), height = 2 * kNoiseTilePx + 1;
      const DepthImage image(width, height, shift, measured, random);
      for (const int step : {1, 2}) {
        for (const int left : {0, width - kNoiseTilePx}) {
          for (const int top : {0, height - kNoiseTilePx}) {
            const Roughness expected = specified.roughness(image.view, left, top, step);
            const Roughness found = kernels.roughness(image.view, left, top, step);
            ASSERT_EQ(0, std::memcmp(&expected, &found, sizeof(found))) << width << ' ' << step;
            ASSERT_EQ(measured > 0, found.count > 0);
          }
        }
      }
    }
  }
}

void expect_same_gradients(const FeatureKernels& kernels, const std::vector<std::uint8_t>& image,
                           std::ptrdiff_t stride, int width, std::int32_t threshold_squared,
                           int shift) {
  GuardedRow<std::uint8_t> expected(width, shift), found(width, shift);
  const std::uint8_t* row = image.data() + shift + stride;
  feature_kernels_scalar().gradient_row(row, stride, width, threshold_squared, expected.first);
  kernels.gradient_row(row, stride, width, threshold_squared, found.first);
  ASSERT_EQ(expected.bytes, found.bytes) << "width " << width << ", shift " << shift;
}

TEST_P(FeatureKernelsOf, GradientRowAgreesOnEverySizeAndStart) {
  for (int width = 0; width <= 2 * 64 + 1; ++width) {
    for (const int shift : {0, 1, 31}) {
      const std::ptrdiff_t stride = width + 3;
      std::vector<std::uint8_t> image(static_cast<std::size_t>(shift + 2 * stride + width));
      for (auto& b : image) b = random_byte(random);
      expect_same_gradients(kernels, image, stride, width, 0, shift);
      expect_same_gradients(kernels, image, stride, width, 120 * 120, shift);
      // Small gradients: every direction of small integers, exactly on boundaries too.
      for (auto& b : image) b = static_cast<std::uint8_t>(100 + random() % 3);
      expect_same_gradients(kernels, image, stride, width, 4, shift);
    }
  }
}

TEST_P(FeatureKernelsOf, GradientRowAgreesOnTheStrongestEdges) {
  std::vector<std::uint8_t> image(3 * 130);
  for (int i = 0; i < 40; ++i) {
    for (auto& b : image) b = random() % 2 == 0 ? 0 : 255;
    expect_same_gradients(kernels, image, 130, 130, 1, 0);
  }
  std::fill(image.begin(), image.end(), std::uint8_t{255});
  expect_same_gradients(kernels, image, 130, 130, 0, 0);
}

INSTANTIATE_TEST_SUITE_P(EachIsa, FeatureKernelsOf, testing::ValuesIn(kAllIsas),
                         [](const auto& unit) { return std::string(isa_name(unit.param)); });

float halved(float a, float b, float c, float d) {
  const float pixels[] = {a, b, c, d};
  float out = -1;
  feature_kernels_scalar().halve_row(pixels, 2, 1, &out);
  return out;
}

TEST(HalvedDepth, IsOfTheNearerSurfaceUnlessOnePixelAloneShowsIt) {
  EXPECT_FLOAT_EQ(501.5f, halved(500, 501, 502, 503));
  EXPECT_FLOAT_EQ(501, halved(500, 0, 502, 0));
  EXPECT_FLOAT_EQ(500.5f, halved(500, 501, 520, 521));
  EXPECT_FLOAT_EQ(521, halved(500, 520, 521, 522));
  EXPECT_FLOAT_EQ(500, halved(500, 520, 0, 0));
  EXPECT_EQ(0, halved(500, 0, 0, 0));
  EXPECT_EQ(0, halved(0, 0, 0, 0));
}

TEST(PooledNormals, NeedTwoOfFour) {
  for (const int count : {0, 1, 2, 3, 4}) {
    float x[4] = {}, y[4] = {};
    std::uint8_t valid[4] = {};
    for (int i = 0; i < count; ++i) {
      x[i] = 0.1f * static_cast<float>(i);
      y[i] = -0.5f;
      valid[i] = 1;
    }
    float px = -1, py = -1;
    std::uint8_t pooled = 9;
    feature_kernels_scalar().pool_row({x, y, valid}, 2, 1, {&px, &py, &pooled});
    EXPECT_EQ(count >= 2, pooled) << count;
    EXPECT_FLOAT_EQ(count >= 2 ? 0.05f * static_cast<float>(count - 1) : 0, px) << count;
    EXPECT_FLOAT_EQ(count >= 2 ? -0.5f : 0, py) << count;
  }
}

}  // namespace
}  // namespace binpick::simd
