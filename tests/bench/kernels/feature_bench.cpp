#include <memory>

#include "bench/kernels/kernel_bench.hpp"
#include "kernels/kernel_inputs.hpp"

namespace binpick::simd {
namespace {

// The level at which features are found, of a region 704 px wide; of its height a strip, since the
// pyramid is built strip by strip.
constexpr int kWidth = 352, kHeight = 64, kRim = 2;
constexpr auto kPixels = static_cast<std::size_t>(kWidth) * kHeight;

struct FeatureInputs {
  FeatureInputs()
      : gray(kPixels),
        bits(kPixels),
        valid(kPixels),
        valid_pooled(kPixels),
        depth_mm(4 * kPixels),
        halved_mm(kPixels),
        x(kPixels),
        y(kPixels),
        x_pooled(kPixels),
        y_pooled(kPixels) {
    std::mt19937 random(7);
    for (std::uint8_t& pixel : gray) pixel = random_byte(random);
    // Slanted surfaces with noise, steps and holes.
    for (std::size_t i = 0; i < depth_mm.size(); ++i) {
      const auto column = static_cast<float>(i % (2 * kWidth));
      depth_mm[i] = 600 + 0.1f * column + static_cast<float>(random() % 1000) * 2e-4f;
      if (i / 40 % 4 == 0) depth_mm[i] += 30;
      if (random() % 16 == 0) depth_mm[i] = 0;
    }
    for (int row = kRim; row < kHeight - kRim; ++row)
      feature_kernels_scalar().fit_row(depth(), camera(), row, normals(row));
  }
  static CameraIntrinsics camera() { return {kWidth, kHeight, 950, 950, 176, 32}; }
  ImageView<const float> depth() const { return {depth_mm.data(), kWidth, kHeight, kWidth}; }
  NormalRow normals(int row) { return row_of(x, y, valid, row); }
  NormalRow pooled(int row) { return row_of(x_pooled, y_pooled, valid_pooled, row); }
  std::uint8_t* bits_row(int row) { return bits.data() + std::ptrdiff_t{row} * kWidth; }

  static NormalRow row_of(std::vector<float>& x, std::vector<float>& y,
                          std::vector<std::uint8_t>& valid, int row) {
    const std::ptrdiff_t first = std::ptrdiff_t{row} * kWidth;
    return {x.data() + first, y.data() + first, valid.data() + first};
  }
  std::vector<std::uint8_t> gray, bits, valid, valid_pooled;
  std::vector<float> depth_mm, halved_mm, x, y, x_pooled, y_pooled;
};

}  // namespace

void add_feature_kernels(const KernelTable& table) {
  const auto in = std::make_shared<FeatureInputs>();
  const FeatureKernels& kernels = table.features;
  // Bytes that each pixel of the width takes on the way in and out, over `rows` rows of such.
  const auto add = [&](const char* name, int width, int bytes, int rows, auto call) {
    const Traffic traffic{static_cast<double>(bytes) * width,
                          static_cast<double>(bytes) * width * rows};
    add_benchmark(std::string(name) + "/" + table.name, traffic,
                  [=](int i) { call(kRim + i % (rows - 2 * kRim)); });
  };
  add("gradient_row", kWidth, 2, kHeight, [=](int y) {
    kernels.gradient_row(in->gray.data() + y * kWidth, kWidth, kWidth, 1000, in->bits_row(y));
  });
  add("step_row", kWidth, 5, kHeight,
      [=](int y) { kernels.step_row(in->depth(), y, 1e-6f, in->bits_row(y)); });
  add("fit_row", kWidth, 13, kHeight,
      [=](int y) { kernels.fit_row(in->depth(), FeatureInputs::camera(), y, in->normals(y)); });
  add("normal_bits_row", kWidth, 10, kHeight, [=](int y) {
    kernels.normal_bits_row(NormalCodebook::kHemisphere, in->normals(y), kWidth, in->bits_row(y));
  });
  add("pool_row", kWidth / 2, 45, kHeight / 2,
      [=](int y) { kernels.pool_row(in->normals(2 * y), kWidth, kWidth / 2, in->pooled(y)); });
  add("halve_row", kWidth, 20, kHeight, [=](int y) {
    kernels.halve_row(in->depth_mm.data() + 4 * y * kWidth, 2 * kWidth, kWidth,
                      in->halved_mm.data() + y * kWidth);
  });
  const Traffic tile{4.0 * kNoiseTilePx * kNoiseTilePx, 4.0 * kPixels};
  add_benchmark(std::string("roughness/") + table.name, tile, [=](int i) {
    benchmark::DoNotOptimize(kernels.roughness(in->depth(), i % 12 * 24, i / 12 % 2 * 24, 1));
  });
}

}  // namespace binpick::simd
