#include "features/pyramid.hpp"

#include <algorithm>
#include <cstring>

#include "binpick/base/arena_plan.hpp"

namespace binpick {
namespace {

// Sobel magnitude of an edge where nothing but the intensity is seen: between areas that differ by
// about twenty gray levels. Grain and scratches of a surface stay below, most outlines do not.
constexpr std::int32_t kGradientThreshold = 90;
// Where there is depth to show the outlines, only strong edges of the intensity are taken:
// textures, scratches and threads answer to the weaker threshold nearly everywhere.
constexpr std::int32_t kStrongGradient = 120;
// Blocks' rows that one task rearranges.
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

template <class Source>
std::span<float> take_noise_scratch(const PyramidPlan& plan, Source& source) {
  return source.template take<float>(static_cast<std::size_t>(
      noise_scratch_size(plan.width_max >> kFeatureLevel, plan.height_max >> kFeatureLevel)));
}

template <class Source>
std::span<std::uint8_t> take_thin_edges(const PyramidPlan& plan, Source& source) {
  return source.template take<std::uint8_t>(static_cast<std::size_t>(
      image_stride(plan, kFeatureLevel) * (plan.height_max >> kFeatureLevel)));
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
  m.depth = source.template take<float>(pixels);
  if (l <= kFeatureLevel) m.gray = source.template take<std::uint8_t>(pixels);
  if (l >= kFeatureLevel) {
    m.nx = source.template take<float>(pixels);
    m.ny = source.template take<float>(pixels);
    m.valid = source.template take<std::uint8_t>(pixels);
  }
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
  take_thin_edges(plan, counted);
  for (int l = 0; l < plan.level_count; ++l) take_level(plan, l, counted);
  return counted.bytes;
}

FeaturePyramid::FeaturePyramid(const PyramidPlan& plan, Arena& arena)
    : plan_(plan),
      thin_edges_(take_thin_edges(plan, arena)),
      noise_scratch_(take_noise_scratch(plan, arena)) {
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
    maps_[l] = {m.gradient, m.normal, m.blocks};
    level.plain.stride = map_stride(plan, l);
    level.plain.gradient = gradient_row(l, 0);
    level.plain.normal = normal_row(l, 0);
    if (plan.rearranged_from_level[l]) {
      const std::ptrdiff_t stride_blocks = level.plain.stride / 2;
      level.rearranged = {
          m.blocks.data() + plan.border / 2 * (stride_blocks + 1) * simd::kBlockBytes,
          stride_blocks};
    }
  }
}

void FeaturePyramid::build(const Frame& frame, const Roi& region, NormalCodebook codebook,
                           const simd::KernelTable& kernels, WorkerPool& pool, int finest_map) {
  finest_map_ = finest_map;
  place_levels(frame, region);
  const int strips = region.height >> (plan_.level_count - 1);
  pool.parallel_for(strips, [&](int s, int) { load_strip(s, frame, kernels.features); });
  const PyramidLevel& fitted = levels_[kFeatureLevel];
  depth_noise_ = estimate_depth_noise({fitted.depth_mm, fitted.width, fitted.height, fitted.stride},
                                      kernels.features, noise_scratch_, pool);
  pool.parallel_for(strips, [&](int s, int) { find_features(s, kernels.features); });
  clear_moved_maps();
  pool.parallel_for(strips, [&](int s, int) { fill_maps(s, codebook, kernels.features); });
  for (int l = finest_map; l < plan_.level_count; ++l) {
    if (plan_.rearranged_from_level[l]) rearrange(l, pool);
  }
}

void FeaturePyramid::place_levels(const Frame& frame, const Roi& region) {
  const int aligned = 1 << (plan_.level_count - 1);
  BINPICK_ASSERT(region.width % aligned == 0 && region.height % aligned == 0 &&
                 region.width <= plan_.width_max && region.height <= plan_.height_max);
  with_intensity_ = frame.intensity.width > 0;
  depth_valid_ = !frame.depth_mm.empty();
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
}

simd::NormalRow FeaturePyramid::normals(int l, int y) const {
  const PyramidLevel& level = levels_[l];
  const std::ptrdiff_t at = y * level.stride;
  return {level.normal_x + at, level.normal_y + at, level.normal_valid + at};
}

// The pixels of the frame, and halved ones.
void FeaturePyramid::load_strip(int strip, const Frame& frame,
                                const simd::FeatureKernels& kernels) {
  const Rows rows = rows_of(strip, 0);
  for (int y = rows.first; y < rows.end; ++y) copy_row(y, frame);
  for (int l = 1; l < plan_.level_count; ++l) {
    const PyramidLevel &fine = levels_[l - 1], &coarse = levels_[l];
    const Rows halved = rows_of(strip, l);
    for (int y = halved.first; y < halved.end; ++y) {
      kernels.halve_row(fine.depth_mm + 2 * y * fine.stride, fine.stride, coarse.width,
                        coarse.depth_mm + y * coarse.stride);
      if (l > kFeatureLevel) continue;
      const std::uint8_t *a = fine.gray + 2 * y * fine.stride, *b = a + fine.stride;
      std::uint8_t* gray = coarse.gray + y * coarse.stride;
      for (int x = 0; x < coarse.width; ++x) {
        gray[x] =
            static_cast<std::uint8_t>((a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1] + 2) >> 2);
      }
    }
  }
}

void FeaturePyramid::copy_row(int y, const Frame& frame) {
  PyramidLevel& level = levels_[0];
  std::uint8_t* gray = level.gray + y * level.stride;
  float* depth = level.depth_mm + y * level.stride;
  const int row = region_.y + y;
  const auto columns = [&](int width, int height) {
    return row < height ? std::clamp(width - region_.x, 0, level.width) : 0;
  };
  int width = columns(frame.intensity.width, frame.intensity.height);
  if (width > 0) std::copy_n(frame.intensity.row(row) + region_.x, width, gray);
  std::fill(gray + width, gray + level.width, std::uint8_t{0});
  width = columns(frame.depth_mm.width, frame.depth_mm.height);
  // NaN, infinite and negative values mean no measurement.
  const float* from = width > 0 ? frame.depth_mm.row(row) + region_.x : nullptr;
  for (int x = 0; x < width; ++x) {
    const bool measured = from[x] >= simd::kDepthMin_mm && from[x] < simd::kDepthMax_mm;
    depth[x] = measured ? from[x] : 0.0f;
  }
  std::fill(depth + width, depth + level.width, 0.0f);
}

// Normals, and thin edges of intensity and depth, of kFeatureLevel. Rows and columns at the rim,
// where the neighbours are missing, have none.
void FeaturePyramid::find_features(int strip, const simd::FeatureKernels& kernels) {
  const PyramidLevel& level = levels_[kFeatureLevel];
  const ImageView<const float> depth{level.depth_mm, level.width, level.height, level.stride};
  const std::int32_t threshold = depth_valid_ ? kStrongGradient : kGradientThreshold;
  const auto noise = static_cast<float>(depth_noise_.of_neighbours);
  const auto clear_rim = [&](int y, int rim, auto* row) {
    const bool inside = y >= rim && y < level.height - rim && level.width > 2 * rim;
    std::fill_n(row, inside ? rim : level.width, 0);
    std::fill_n(row + level.width - rim, inside ? rim : 0, 0);
    return inside;
  };
  const Rows rows = rows_of(strip, kFeatureLevel);
  for (int y = rows.first; y < rows.end; ++y) {
    const simd::NormalRow n = normals(kFeatureLevel, y);
    clear_rim(y, 2, n.x);
    clear_rim(y, 2, n.y);
    if (clear_rim(y, 2, n.valid)) kernels.fit_row(depth, level.camera, y, n);
    const std::ptrdiff_t at = y * level.stride;
    std::uint8_t *thin = thin_edges_.data() + at, *steps = level.depth_edges + at;
    clear_rim(y, 1, thin);
    if (!clear_rim(y, 1, steps)) continue;
    kernels.gradient_row(level.gray + at, level.stride, level.width, threshold * threshold, thin);
    kernels.step_row(depth, y, noise, steps);
    for (int x = 0; x < level.width; ++x) thin[x] = static_cast<std::uint8_t>(thin[x] | steps[x]);
  }
}

// Where the region has another size than before, what the maps showed outside it must go.
void FeaturePyramid::clear_moved_maps() {
  for (int l = std::min(finest_map_, kFeatureLevel); l < plan_.level_count; ++l) {
    MapMemory& m = maps_[l];
    if (m.width == levels_[l].width && m.height == levels_[l].height) continue;
    for (const std::span<std::uint8_t> map : {m.gradient, m.normal, m.blocks})
      std::fill(map.begin(), map.end(), std::uint8_t{0});
    m.width = levels_[l].width;
    m.height = levels_[l].height;
  }
}

// The maps of kFeatureLevel; those below repeat them, those above collect from the level before.
void FeaturePyramid::fill_maps(int strip, NormalCodebook codebook,
                               const simd::FeatureKernels& kernels) {
  const auto for_rows = [&](int l, auto&& fn) {
    const Rows rows = rows_of(strip, l);
    for (int y = rows.first; y < rows.end; ++y) fn(y);
  };
  const auto quantize = [&](int l, int y) {
    kernels.normal_bits_row(codebook, normals(l, y), levels_[l].width, normal_row(l, y));
  };
  for_rows(kFeatureLevel, [&](int y) {
    spread_edges(y);
    quantize(kFeatureLevel, y);
  });
  for (int l = kFeatureLevel - 1; l >= finest_map_; --l)
    for_rows(l, [&](int y) { repeat_maps(l, y); });
  for (int l = kFeatureLevel + 1; l < plan_.level_count; ++l) {
    for_rows(l, [&](int y) {
      collect_edges(l, y);
      kernels.pool_row(normals(l - 1, 2 * y), levels_[l - 1].stride, levels_[l].width,
                       normals(l, y));
      quantize(l, y);
    });
  }
}

// Measured outlines are off by a pixel or two: each is spread to its neighbours.
void FeaturePyramid::spread_edges(int y) {
  const PyramidLevel& level = levels_[kFeatureLevel];
  const int last = level.width - 1;
  const std::uint8_t* thin = thin_edges_.data() + y * level.stride;
  const std::uint8_t* above = y > 0 ? thin - level.stride : thin;
  const std::uint8_t* below = y + 1 < level.height ? thin + level.stride : thin;
  std::uint8_t* to = gradient_row(kFeatureLevel, y);
  // The rim has no edges of its own.
  to[0] = thin[std::min(1, last)];
  to[last] = thin[std::max(0, last - 1)];
  for (int x = 1; x < last; ++x)
    to[x] = static_cast<std::uint8_t>(thin[x - 1] | thin[x] | thin[x + 1] | above[x] | below[x]);
}

void FeaturePyramid::repeat_maps(int to, int y) {
  const std::uint8_t *from_gradient = gradient_row(to + 1, y / 2),
                     *from_normal = normal_row(to + 1, y / 2);
  std::uint8_t *gradient = gradient_row(to, y), *normal = normal_row(to, y);
  const float* depth = levels_[to].depth_mm + y * levels_[to].stride;
  for (int x = 0; x < levels_[to].width; ++x) {
    gradient[x] = from_gradient[x / 2];
    normal[x] = depth[x] > 0 ? from_normal[x / 2] : std::uint8_t{0};
  }
}

void FeaturePyramid::collect_edges(int to, int y) {
  const std::uint8_t *a = gradient_row(to - 1, 2 * y), *b = gradient_row(to - 1, 2 * y + 1);
  std::uint8_t* out = gradient_row(to, y);
  for (int x = 0; x < levels_[to].width; ++x)
    out[x] = static_cast<std::uint8_t>(a[2 * x] | a[2 * x + 1] | b[2 * x] | b[2 * x + 1]);
}

// Only the blocks that take in pixels of the level: the others stay zero.
void FeaturePyramid::rearrange(int l, WorkerPool& pool) {
  const PyramidLevel& level = levels_[l];
  const MapMemory& m = maps_[l];
  const std::ptrdiff_t stride = level.plain.stride;
  const int first = std::max(0, level.border / 2 - 1);
  const int rows = (level.border + level.height + 1) / 2 - first;
  const int columns = (level.border + level.width + 1) / 2 - first;
  pool.parallel_for((rows + kRowsPerTask - 1) / kRowsPerTask, [&](int task, int) {
    const int end = first + std::min(rows, (task + 1) * kRowsPerTask);
    for (int r = first + task * kRowsPerTask; r < end; ++r) {
      const std::uint8_t* g = m.gradient.data() + 2 * r * stride + 2 * first;
      const std::uint8_t* n = m.normal.data() + 2 * r * stride + 2 * first;
      std::uint8_t* out = m.blocks.data() + (r * (stride / 2) + first) * simd::kBlockBytes;
      for (int c = 0; c < columns; ++c, out += simd::kBlockBytes) {
        for (int k = 0; k < 4; ++k) {
          std::memcpy(out + 4 * k, g + k * stride + 2 * c, 4);
          std::memcpy(out + 16 + 4 * k, n + k * stride + 2 * c, 4);
        }
      }
    }
  });
}

}  // namespace binpick
