// How much the depth of a frame scatters, read off the frame itself: sensors differ by far more
// than their cameras tell, and no two of them report it alike. 1/z of a plane is linear in the
// image, so its second differences are errors, or curvature; curvature is kept out by looking at
// the smoothest places only.
#pragma once

#include <span>

#include "binpick/base/worker_pool.hpp"
#include "binpick/frame/image_view.hpp"
#include "simd/feature_kernels.hpp"

namespace binpick {

// Standard deviations of 1/z, in 1/mm, of one pixel of the image looked at. That of the depth is
// z^2 times it, as errors of triangulation grow. 0 where there is too little to tell by.
struct DepthNoise {
  double of_neighbours = 0;  // against pixels beside it: what may look like a step
  double of_patches = 0;     // against pixels two apart: nearly all that moves a surface

  static double mm(double of_inverse, double depth_mm) { return of_inverse * depth_mm * depth_mm; }
};

// How many entries `scratch` needs for an image.
inline int noise_scratch_size(int width, int height) {
  return 2 * (width / simd::kNoiseTilePx) * (height / simd::kNoiseTilePx);
}

// The same bits on any number of threads.
DepthNoise estimate_depth_noise(ImageView<const float> depth_mm,
                                const simd::FeatureKernels& kernels, std::span<float> scratch,
                                WorkerPool& pool);

}  // namespace binpick
