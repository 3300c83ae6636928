// The feature pyramid of one frame: for each level the intensity and depth, both orientation maps
// with a border of zeros, and the rearranged map. Covers the region of interest and a margin around
// it. Memory comes from the arena once; build() fills it for every frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "binpick/base/arena.hpp"
#include "binpick/base/worker_pool.hpp"
#include "binpick/frame/frame.hpp"
#include "binpick/model/normal_codebook.hpp"
#include "features/depth_noise.hpp"
#include "simd/kernel_table.hpp"

namespace binpick {

inline constexpr int kPyramidLevelsMax = 8;
// Level at which planes are fitted and edges are found; finer levels repeat its features, coarser
// ones collect them, as the templates' histograms are collected from fine to coarse (Algorithm 1).
inline constexpr int kFeatureLevel = 1;

struct PyramidLevel {
  int width = 0, height = 0;     // of this frame
  std::uint8_t* gray = nullptr;  // up to kFeatureLevel
  float* depth_mm = nullptr;
  float* normal_x = nullptr;  // from kFeatureLevel on; in ray frames, valid where normal_valid
  float* normal_y = nullptr;
  std::uint8_t* normal_valid = nullptr;
  std::uint8_t* depth_edges = nullptr;  // orientation bits of depth steps; of kFeatureLevel alone
  std::ptrdiff_t stride = 0;            // of the ones above
  CameraIntrinsics camera;              // of the cropped level
  simd::PlainMaps plain{};
  simd::RearrangedMap rearranged{};
  int border = 0;  // px of zeros around the maps
};

struct PyramidPlan {
  int width_max = 0, height_max = 0;  // of the region with its margin, level 0
  int level_count = 0;
  int border = 0;  // px, the same at each level; a multiple of 4
  bool rearranged_from_level[kPyramidLevelsMax] = {};  // which levels need the rearranged map
};

class FeaturePyramid {
 public:
  static std::size_t footprint(const PyramidPlan& plan);
  FeaturePyramid(const PyramidPlan& plan, Arena& arena);

  // Fills all levels from the pixels of `region`, which may reach beyond the frame: at most
  // width_max x height_max, origin and size multiples of 2^(levels-1). The maps of levels below
  // `finest_map` are left as they are: nobody reads them.
  void build(const Frame& frame, const Roi& region, NormalCodebook codebook,
             const simd::KernelTable& kernels, WorkerPool& pool, int finest_map = 0);

  const PyramidLevel& level(int l) const { return levels_[l]; }
  int level_count() const { return plan_.level_count; }
  const Roi& region() const { return region_; }
  bool with_intensity() const { return with_intensity_; }  // the frame has an intensity image
  bool with_depth() const { return depth_valid_; }         // the frame has a depth image
  // Of the depth of kFeatureLevel.
  const DepthNoise& depth_noise() const { return depth_noise_; }

 private:
  // Both maps and their blocks, with the border of zeros that they keep.
  struct MapMemory {
    std::span<std::uint8_t> gradient, normal, blocks;
    int width = 0, height = 0;  // of the area that is written to
  };
  struct Rows {
    int first, end;
  };

  void place_levels(const Frame& frame, const Roi& region);
  // Each does what it says for one strip: the rows of all levels that one row of the coarsest level
  // covers.
  void load_strip(int strip, const Frame& frame, const simd::FeatureKernels& kernels);
  void find_features(int strip, const simd::FeatureKernels& kernels);
  void fill_maps(int strip, NormalCodebook codebook, const simd::FeatureKernels& kernels);
  void copy_row(int y, const Frame& frame);
  void spread_edges(int y);
  void repeat_maps(int to, int y);
  void collect_edges(int to, int y);
  void clear_moved_maps();
  void rearrange(int l, WorkerPool& pool);
  Rows rows_of(int strip, int l) const {
    const int rows = 1 << (plan_.level_count - 1 - l);
    return {strip * rows, (strip + 1) * rows};
  }
  simd::NormalRow normals(int l, int y) const;
  std::uint8_t* gradient_row(int l, int y) { return map_row(l, y, maps_[l].gradient); }
  std::uint8_t* normal_row(int l, int y) { return map_row(l, y, maps_[l].normal); }
  std::uint8_t* map_row(int l, int y, std::span<std::uint8_t> map) const {
    return map.data() + (plan_.border + y) * levels_[l].plain.stride + plan_.border;
  }

  PyramidPlan plan_;
  PyramidLevel levels_[kPyramidLevelsMax];
  MapMemory maps_[kPyramidLevelsMax];
  std::span<std::uint8_t> thin_edges_;  // orientation bits of kFeatureLevel, before they are spread
  std::span<float> noise_scratch_;
  Roi region_;
  DepthNoise depth_noise_;
  bool depth_valid_ = false;
  bool with_intensity_ = false;
  int finest_map_ = 0;
};

}  // namespace binpick
