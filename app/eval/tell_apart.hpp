// Whether the measured depth tells one pose of a part from another: both are rendered, and compared
// with what was measured at the pixels where they differ. It knows nothing of the detector's own
// evidence, so that it can judge it. Intensity is not looked at. Thread: one comparison at a time.
#pragma once

#include <map>
#include <memory>

#include "binpick/frame/frame.hpp"
#include "binpick/train/renderer.hpp"

namespace binpick::app {

struct PoseComparison {
  int silhouette_px = 0;    // of the first pose, inside the image
  int measured_px = 0;      // of those: with a depth near the pose's surface, or behind it
  int supported_px = 0;     // of those: near it
  double noise_mm = 0;      // spread of the measurement around the first pose's surface
  int differing_px = 0;     // where the two poses say something else
  double advantage_px = 0;  // of the first pose over the second: pixels that speak for it, net

  // Share of the silhouette with a measurement that shows the part.
  double measured_share() const {
    return silhouette_px > 0 ? static_cast<double>(measured_px) / silhouette_px : 0;
  }
  // The net advantage as a share of what is seen of the part.
  double advantage() const { return measured_px > 0 ? advantage_px / measured_px : 0; }
};

class PoseComparer {
 public:
  // Both poses of the same mesh, which outlives the comparer. Throws RenderError.
  PoseComparison compare(const Frame& frame, const train::Mesh& mesh, const Pose& first,
                         const Pose& second);

 private:
  std::map<const train::Mesh*, std::unique_ptr<train::Renderer>> renderers_;
  train::RenderedView first_, second_;
};

// How much a pixel speaks against a rendered surface: 0 where the measurement lies on it, 1/2 where
// nothing can be said (not rendered there, or something stands in front), 1 where the measurement
// lies behind the surface.
double pixel_cost(double measured_mm, double rendered_mm, double tolerance_mm);

}  // namespace binpick::app
