#include "features/pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "binpick/base/arena_plan.hpp"
#include "features/orientation.hpp"
#include "features/surface_slope.hpp"

namespace binpick {
namespace {

// Sobel magnitude of an edge where nothing but the intensity is seen: between areas that differ by
// about twenty gray levels. Grain and scratches of a surface stay below, most outlines do not.
constexpr std::int32_t kGradientThreshold = 90;
// Where there is depth to show the outlines, only strong edges of the intensity are taken:
// textures, scratches and threads answer to the weaker threshold nearly everywhere.
constexpr std::int32_t kStrongGradient = 120;
// Rows that one task works on.
constexpr int kRowsPerTask = 16;

std::ptrdiff_t map_stride(const PyramidPlan& plan, int l) {
  return ((plan.width_max >> l) + 2 * plan.border + simd::kReadAhead + 63) / 64 * 64;
}
std::ptrdiff_t map_rows(const PyramidPlan& plan, int l) {
  return (plan.height_max >> l) + 2 * plan.border + 4;
}
std::ptrdiff_t image_stride(const PyramidPlan& plan, int l) {
  return ((plan.width_max >> l) + 15) / 16 * 16;
}

template <class RowFn>
void for_rows(WorkerPool& pool, int height, RowFn&& fn) {
  const int tasks = (height + kRowsPerTask - 1) / kRowsPerTask;
  pool.parallel_for(tasks, [&](int task, int) {
    for (int y = task * kRowsPerTask; y < std::min(height, (task + 1) * kRowsPerTask); ++y) fn(y);
  });
}

// Depth of four pixels as one: the mean of the nearer surface, unless only one pixel shows it.
float merged_depth(const float (&z)[4]) {
  float nearest = 0;
  int valid = 0;
  for (float v : z) {
    if (!(v > 0)) continue;
    nearest = valid == 0 ? v : std::min(nearest, v);
    ++valid;
  }
  if (valid < 2) return 0;
  const float limit = nearest * (1 + kSameSurfaceRatio);
  float near_sum = 0, far_sum = 0;
  int near_count = 0, far_count = 0;
  for (float v : z) {
    if (!(v > 0)) continue;
    (v <= limit ? near_sum : far_sum) += v;
    ++(v <= limit ? near_count : far_count);
  }
  if (near_count >= 2 || far_count < 2) return near_sum / static_cast<float>(near_count);
  return far_sum / static_cast<float>(far_count);
}

template <class Source>
std::span<float> take_noise_scratch(const PyramidPlan& plan, Source& source) {
  return source.template take<float>(static_cast<std::size_t>(
      noise_scratch_size(plan.width_max >> kFeatureLevel, plan.height_max >> kFeatureLevel)));
}

struct LevelMemory {
  std::span<std::uint8_t> gray, valid, depth_edges, gradient, normal, blocks;
  std::span<float> depth, nx, ny;
};

// The one list of what a level takes, for planning and for taking.
template <class Source>
LevelMemory take_level(const PyramidPlan& plan, int l, Source& source) {
  LevelMemory m;
  const auto pixels = static_cast<std::size_t>(image_stride(plan, l) * (plan.height_max >> l));
  const auto map = static_cast<std::size_t>(map_stride(plan, l) * map_rows(plan, l));
  m.gray = source.template take<std::uint8_t>(pixels);
  m.depth = source.template take<float>(pixels);
  m.nx = source.template take<float>(pixels);
  m.ny = source.template take<float>(pixels);
  m.valid = source.template take<std::uint8_t>(pixels);
  if (l == kFeatureLevel) m.depth_edges = source.template take<std::uint8_t>(pixels);
  m.gradient = source.template take<std::uint8_t>(map);
  m.normal = source.template take<std::uint8_t>(map);
  if (plan.rearranged_from_level[l]) {
    m.blocks =
        source.template take<std::uint8_t>(map / 4 * static_cast<std::size_t>(simd::kBlockBytes));
  }
  return m;
}

}  // namespace

std::size_t FeaturePyramid::footprint(const PyramidPlan& plan) {
  ArenaPlan counted;
  take_noise_scratch(plan, counted);
  for (int l = 0; l < plan.level_count; ++l) take_level(plan, l, counted);
  return counted.bytes;
}

FeaturePyramid::FeaturePyramid(const PyramidPlan& plan, Arena& arena)
    : plan_(plan), noise_scratch_(take_noise_scratch(plan, arena)) {
  BINPICK_ASSERT(plan.level_count > kFeatureLevel && plan.level_count <= kPyramidLevelsMax &&
                 plan.border % 4 == 0);
  for (int l = 0; l < plan.level_count; ++l) {
    const LevelMemory m = take_level(plan, l, arena);
    PyramidLevel& level = levels_[l];
    level.gray = m.gray.data();
    level.depth_mm = m.depth.data();
    level.normal_x = m.nx.data();
    level.normal_y = m.ny.data();
    level.normal_valid = m.valid.data();
    level.depth_edges = m.depth_edges.data();
    level.stride = image_stride(plan, l);
    level.border = plan.border;
    gradient_maps_[l] = m.gradient.data();
    normal_maps_[l] = m.normal.data();
    block_maps_[l] = m.blocks.data();
    map_bytes_[l] = m.gradient.size();
    const std::ptrdiff_t stride = map_stride(plan, l), origin = plan.border * stride + plan.border;
    level.plain = {gradient_maps_[l] + origin, normal_maps_[l] + origin, stride};
    if (plan.rearranged_from_level[l]) {
      const std::ptrdiff_t stride_blocks = stride / 2;
      level.rearranged = {
          block_maps_[l] + (plan.border / 2 * stride_blocks + plan.border / 2) * simd::kBlockBytes,
          stride_blocks};
    }
  }
}

void FeaturePyramid::build(const Frame& frame, const Roi& region, NormalCodebook codebook,
                           const simd::KernelTable& kernels, WorkerPool& pool) {
  with_intensity_ = frame.intensity.width > 0;
  region_ = region;
  for (int l = 0; l < plan_.level_count; ++l) {
    PyramidLevel& level = levels_[l];
    level.width = region.width >> l;
    level.height = region.height >> l;
    CameraIntrinsics cropped = frame.camera;
    cropped.width = region.width;
    cropped.height = region.height;
    cropped.cx -= region.x;
    cropped.cy -= region.y;
    level.camera = cropped.at_level(l);
  }
  depth_valid_ = !frame.depth_mm.empty();
  copy_level_zero(frame, pool);
  for (int l = 1; l < plan_.level_count; ++l) halve(l, pool);
  const PyramidLevel& fitted = levels_[kFeatureLevel];
  depth_noise_ = estimate_depth_noise({fitted.depth_mm, fitted.width, fitted.height, fitted.stride},
                                      noise_scratch_, pool);
  fit_normals(pool);
  for (int l = kFeatureLevel + 1; l < plan_.level_count; ++l) pool_normals(l, pool);
  for (int l = 0; l < plan_.level_count; ++l) {
    std::memset(gradient_maps_[l], 0, map_bytes_[l]);
    std::memset(normal_maps_[l], 0, map_bytes_[l]);
  }
  find_edges(kernels, pool);
  for (int l = kFeatureLevel - 1; l >= 0; --l) carry_edges(l, pool);
  for (int l = kFeatureLevel + 1; l < plan_.level_count; ++l) carry_edges(l, pool);
  for (int l = 0; l < plan_.level_count; ++l) {
    quantize_normals(l, codebook, pool);
    if (plan_.rearranged_from_level[l]) rearrange(l, pool);
  }
}

void FeaturePyramid::copy_level_zero(const Frame& frame, WorkerPool& pool) {
  PyramidLevel& level = levels_[0];
  for_rows(pool, level.height, [&](int y) {
    std::uint8_t* gray = level.gray + y * level.stride;
    float* depth = level.depth_mm + y * level.stride;
    std::fill_n(gray, level.width, std::uint8_t{0});
    std::fill_n(depth, level.width, 0.0f);
    const int row = region_.y + y;
    if (row < frame.intensity.height) {
      const int width = std::min(level.width, frame.intensity.width - region_.x);
      std::copy_n(frame.intensity.row(row) + region_.x, width, gray);
    }
    if (row < frame.depth_mm.height) {
      const int width = std::min(level.width, frame.depth_mm.width - region_.x);
      const float* from = frame.depth_mm.row(row) + region_.x;
      // NaN, infinite and negative values mean no measurement.
      for (int x = 0; x < width; ++x) depth[x] = from[x] > 0 && from[x] < 1e6f ? from[x] : 0.0f;
    }
  });
}

void FeaturePyramid::halve(int to, WorkerPool& pool) {
  const PyramidLevel& fine = levels_[to - 1];
  PyramidLevel& coarse = levels_[to];
  for_rows(pool, coarse.height, [&](int y) {
    const std::uint8_t* g0 = fine.gray + 2 * y * fine.stride;
    const std::uint8_t* g1 = g0 + fine.stride;
    const float* z0 = fine.depth_mm + 2 * y * fine.stride;
    const float* z1 = z0 + fine.stride;
    std::uint8_t* gray = coarse.gray + y * coarse.stride;
    float* depth = coarse.depth_mm + y * coarse.stride;
    for (int x = 0; x < coarse.width; ++x) {
      gray[x] = static_cast<std::uint8_t>(
          (g0[2 * x] + g0[2 * x + 1] + g1[2 * x] + g1[2 * x + 1] + 2) >> 2);
      depth[x] = merged_depth({z0[2 * x], z0[2 * x + 1], z1[2 * x], z1[2 * x + 1]});
    }
  });
}

void FeaturePyramid::fit_normals(WorkerPool& pool) {
  PyramidLevel& level = levels_[kFeatureLevel];
  const ImageView<const float> depth{level.depth_mm, level.width, level.height, level.stride};
  for_rows(pool, level.height, [&](int y) {
    float* nx = level.normal_x + y * level.stride;
    float* ny = level.normal_y + y * level.stride;
    std::uint8_t* valid = level.normal_valid + y * level.stride;
    for (int x = 0; x < level.width; ++x) {
      const bool inside = x >= 2 && y >= 2 && x < level.width - 2 && y < level.height - 2;
      const RayNormal n = inside ? fit_ray_normal(depth, level.camera, x, y) : RayNormal{};
      nx[x] = n.x;
      ny[x] = n.y;
      valid[x] = n.valid;
    }
  });
  PyramidLevel& fine = levels_[0];
  for_rows(pool, fine.height, [&](int y) {
    const std::ptrdiff_t from = std::min(y / 2, level.height - 1) * level.stride;
    for (int x = 0; x < fine.width; ++x) {
      const std::ptrdiff_t i = from + std::min(x / 2, level.width - 1), o = y * fine.stride + x;
      fine.normal_x[o] = level.normal_x[i];
      fine.normal_y[o] = level.normal_y[i];
      fine.normal_valid[o] = level.normal_valid[i] && fine.depth_mm[o] > 0;
    }
  });
}

void FeaturePyramid::pool_normals(int to, WorkerPool& pool) {
  const PyramidLevel& fine = levels_[to - 1];
  PyramidLevel& coarse = levels_[to];
  for_rows(pool, coarse.height, [&](int y) {
    for (int x = 0; x < coarse.width; ++x) {
      const std::ptrdiff_t i = 2 * y * fine.stride + 2 * x;
      float sx = 0, sy = 0;
      int count = 0;
      for (const std::ptrdiff_t k : {i, i + 1, i + fine.stride, i + fine.stride + 1}) {
        if (!fine.normal_valid[k]) continue;
        sx += fine.normal_x[k];
        sy += fine.normal_y[k];
        ++count;
      }
      const std::ptrdiff_t o = y * coarse.stride + x;
      coarse.normal_valid[o] = count >= 2;
      coarse.normal_x[o] = count > 0 ? sx / static_cast<float>(count) : 0;
      coarse.normal_y[o] = count > 0 ? sy / static_cast<float>(count) : 0;
    }
  });
}

void FeaturePyramid::find_edges(const simd::KernelTable& kernels, WorkerPool& pool) {
  const PyramidLevel& level = levels_[kFeatureLevel];
  const ImageView<const float> depth{level.depth_mm, level.width, level.height, level.stride};
  // The thin edges go to the normal map's memory, which is filled later; the spread ones to their
  // place.
  std::uint8_t* thin =
      normal_maps_[kFeatureLevel] + (level.plain.normal - normal_maps_[kFeatureLevel]);
  const bool has_depth = depth_valid_;
  const auto noise = static_cast<float>(depth_noise_.of_neighbours);
  std::memset(level.depth_edges, 0, static_cast<std::size_t>(level.stride * level.height));
  for_rows(pool, level.height, [&](int y) {
    if (y < 1 || y >= level.height - 1) return;
    std::uint8_t* bits = thin + y * level.plain.stride;
    const std::int32_t threshold = has_depth ? kStrongGradient : kGradientThreshold;
    kernels.features.gradient_row(level.gray + y * level.stride, level.stride, level.width,
                                  threshold * threshold, bits);
    std::uint8_t* steps = level.depth_edges + y * level.stride;
    for (int x = 1; x < level.width - 1; ++x) {
      const DepthStep step = depth_step(depth, x, y, noise);
      if (!step.edge) continue;
      steps[x] = gradient_bit(static_cast<std::int32_t>(step.gx * 1024),
                              static_cast<std::int32_t>(step.gy * 1024));
      bits[x] = static_cast<std::uint8_t>(bits[x] | steps[x]);
    }
  });
  // Measured outlines are off by a pixel or two: spread each to its neighbours.
  std::uint8_t* map = gradient_map(kFeatureLevel);
  const std::ptrdiff_t stride = level.plain.stride;
  for_rows(pool, level.height, [&](int y) {
    for (int x = 0; x < level.width; ++x) {
      const std::uint8_t* t = thin + y * stride + x;
      map[y * stride + x] = static_cast<std::uint8_t>(t[0] | t[-1] | t[1] | t[-stride] | t[stride]);
    }
  });
}

// Orientation bits of a level from those of the feature level: repeated below it, collected above
// it.
void FeaturePyramid::carry_edges(int l, WorkerPool& pool) {
  const PyramidLevel& level = levels_[l];
  std::uint8_t* map = gradient_map(l);
  if (l < kFeatureLevel) {
    const PyramidLevel& from = levels_[l + 1];
    for_rows(pool, level.height, [&](int y) {
      const std::uint8_t* row = from.plain.gradient + y / 2 * from.plain.stride;
      for (int x = 0; x < level.width; ++x) map[y * level.plain.stride + x] = row[x / 2];
    });
    return;
  }
  const PyramidLevel& from = levels_[l - 1];
  for_rows(pool, level.height, [&](int y) {
    const std::uint8_t* a = from.plain.gradient + 2 * y * from.plain.stride;
    const std::uint8_t* b = a + from.plain.stride;
    for (int x = 0; x < level.width; ++x) {
      map[y * level.plain.stride + x] =
          static_cast<std::uint8_t>(a[2 * x] | a[2 * x + 1] | b[2 * x] | b[2 * x + 1]);
    }
  });
}

void FeaturePyramid::quantize_normals(int l, NormalCodebook codebook, WorkerPool& pool) {
  const PyramidLevel& level = levels_[l];
  std::uint8_t* map = normal_maps_[l] + (level.plain.normal - normal_maps_[l]);
  for_rows(pool, level.height, [&](int y) {
    std::uint8_t* cells = map + y * level.plain.stride;
    const std::ptrdiff_t row = y * level.stride;
    for (int x = 0; x < level.width; ++x) {
      cells[x] = level.normal_valid[row + x]
                     ? normal_bit(codebook, level.normal_x[row + x], level.normal_y[row + x])
                     : std::uint8_t{0};
    }
  });
}

void FeaturePyramid::rearrange(int l, WorkerPool& pool) {
  const PyramidLevel& level = levels_[l];
  const std::ptrdiff_t stride = level.plain.stride;
  const int border = level.border;
  const int rows = (level.height + 2 * border) / 2, columns = (level.width + 2 * border) / 2;
  for_rows(pool, rows, [&](int r) {
    const std::uint8_t* g = gradient_maps_[l] + 2 * r * stride;
    const std::uint8_t* n = normal_maps_[l] + 2 * r * stride;
    std::uint8_t* out = block_maps_[l] + r * (stride / 2) * simd::kBlockBytes;
    for (int c = 0; c < columns; ++c, out += simd::kBlockBytes) {
      for (int k = 0; k < 4; ++k) {
        std::memcpy(out + 4 * k, g + k * stride + 2 * c, 4);
        std::memcpy(out + 16 + 4 * k, n + k * stride + 2 * c, 4);
      }
    }
  });
}

}  // namespace binpick
