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
  std::uint8_t* gray = nullptr;  // width_max stride
  float* depth_mm = nullptr;
  float* normal_x = nullptr;  // in ray frames, valid where normal_valid
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

  // Fills all levels from the pixels of `region` (which may reach beyond the frame; its origin at
  // multiples of 2^(levels-1), at most width_max x height_max).
  void build(const Frame& frame, const Roi& region, NormalCodebook codebook,
             const simd::KernelTable& kernels, WorkerPool& pool);

  const PyramidLevel& level(int l) const { return levels_[l]; }
  int level_count() const { return plan_.level_count; }
  const Roi& region() const { return region_; }
  bool with_intensity() const { return with_intensity_; }  // the frame has an intensity image
  bool with_depth() const { return depth_valid_; }         // the frame has a depth image
  // Of the depth of kFeatureLevel.
  const DepthNoise& depth_noise() const { return depth_noise_; }

 private:
  void copy_level_zero(const Frame& frame, WorkerPool& pool);
  void halve(int to, WorkerPool& pool);
  void fit_normals(WorkerPool& pool);
  void pool_normals(int to, WorkerPool& pool);
  void find_edges(const simd::KernelTable& kernels, WorkerPool& pool);
  void carry_edges(int l, WorkerPool& pool);
  void quantize_normals(int l, NormalCodebook codebook, WorkerPool& pool);
  void rearrange(int l, WorkerPool& pool);
  std::uint8_t* gradient_map(int l) {
    return gradient_maps_[l] + (levels_[l].plain.gradient - gradient_maps_[l]);
  }

  PyramidPlan plan_;
  PyramidLevel levels_[kPyramidLevelsMax];
  std::uint8_t* gradient_maps_[kPyramidLevelsMax] = {};  // start of the memory, border included
  std::uint8_t* normal_maps_[kPyramidLevelsMax] = {};
  std::uint8_t* block_maps_[kPyramidLevelsMax] = {};
  std::size_t map_bytes_[kPyramidLevelsMax] = {};
  Roi region_;
  std::span<float> noise_scratch_;
  DepthNoise depth_noise_;
  bool depth_valid_ = false;
  bool with_intensity_ = false;
};

}  // namespace binpick
