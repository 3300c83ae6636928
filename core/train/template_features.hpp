// From histograms to a template: threshold, bits, weights (paper section III-A, fourth step), and
// the choice of the pixels that the search will look at.
#pragma once

#include <vector>

#include "binpick/model/object_model.hpp"
#include "train/histogram.hpp"

namespace binpick::train {

// The bits of all bins whose frequency exceeds the threshold; the weight is the largest frequency.
struct DominantOrientation {
  std::uint8_t bits = 0;
  float frequency = 0;  // of the largest bin, 0..1; 0 when no bin is dominant
};

// `scale` turns bin contents into frequencies. The threshold is a frequency too.
template <class T>
DominantOrientation dominant_orientation(const T* bins, float scale, float threshold) {
  DominantOrientation out;
  for (int b = 0; b < kOrientationBins; ++b) {
    const float f = static_cast<float>(bins[b]) * scale;
    if (f <= threshold) continue;
    out.bits = static_cast<std::uint8_t>(out.bits | (1u << b));
    if (f > out.frequency) out.frequency = f;
  }
  return out;
}

// One pixel that could become a feature.
struct FeatureCandidate {
  int x, y;
  DominantOrientation gradient, normal;
};

struct FeatureBudget {
  int contour = 0;  // pixels with a gradient orientation, at most
  int surface = 0;  // pixels with only a normal orientation, at most
};

// Chooses pixels with high weights that are spread over the template, strongest first within each
// kind.
std::vector<Feature> select_features(const std::vector<FeatureCandidate>& candidates,
                                     const FeatureBudget& budget);

}  // namespace binpick::train
