// The parts of the frame check. Each adds what it finds.
#pragma once

#include <array>

#include "binpick/check/frame_check.hpp"

namespace binpick {

// Depths at a grid of pixels of the region, sorted.
struct DepthSamples {
  static constexpr int kSide = 64;
  std::array<float, kSide * kSide> depth_mm;
  int measured = 0;
  int looked_at = 0;

  std::span<const float> values() const {
    return {depth_mm.data(), static_cast<std::size_t>(measured)};
  }
  double quantile(double share) const;  // measured > 0
};

// Pixel steps between samples, so that a region has at most `most` by `most` of them.
inline int sample_step(int size, int most) {
  return size / most + 1;
}
// Where the samples of the k-th row begin: each elsewhere, so that no pattern of columns is missed.
inline int sample_begin(int k, int step) {
  return k % step;
}

// Removes a value that is no measurement from `samples`, so that what follows judges the rest.
void check_depth(const Frame& frame, const PixelRange& region, const FrameCheckRequest& request,
                 DepthSamples& samples, FrameFindings& findings);
void check_intensity(const Frame& frame, const PixelRange& region, FrameFindings& findings);
// Whether depth steps lie on edges of the intensity image, or a number of pixels beside them.
void check_registration(const Frame& frame, const PixelRange& region, FrameFindings& findings);

// Calls visit(model, index) for each model that is wanted.
template <class Visit>
void for_each_wanted(const FrameCheckRequest& request, Visit visit) {
  if (request.wanted.empty()) {
    for (std::size_t i = 0; i < request.models.size(); ++i)
      visit(request.models[i], static_cast<int>(i));
  }
  for (const int index : request.wanted) {
    if (index >= 0 && index < static_cast<int>(request.models.size()))
      visit(request.models[static_cast<std::size_t>(index)], index);
  }
}

}  // namespace binpick
