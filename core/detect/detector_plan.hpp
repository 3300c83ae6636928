// What a detector is built for: pyramid size, borders and search limits that hold for all its
// models, and the region of a frame that it works on.
#pragma once

#include <algorithm>
#include <span>

#include "binpick/detect/detector.hpp"
#include "features/pyramid.hpp"
#include "pose/select.hpp"
#include "search/tree_search.hpp"

namespace binpick {

// Poses that go on from the search: of one model, and of all models of a request, which share them
// evenly.
inline constexpr std::size_t kHypothesesPerModel = 1200;
inline constexpr std::size_t kHypothesesMax = 3000;
// Pixels around the region of interest that are looked at too, so that parts at its rim have their
// outline.
inline constexpr int kRegionMarginPx = 48;

struct DetectorPlan {
  DetectorLimits limits;
  PyramidPlan pyramid;
  SearchLimits search;
  SearchParams search_params;
  NormalCodebook normal_codebook = NormalCodebook::kHemisphere;
  int results_max = 0;

  // Poses that may own pixels of the scene: those of low scores own some too.
  int explained_max() const { return std::max(256, results_max); }

  // Leaf candidates of one model, at most: the limit of any depth, since a shallow tree ends early.
  std::size_t candidates_max() const {
    return static_cast<std::size_t>(
        *std::max_element(search_params.candidates_max, search_params.candidates_max + 4));
  }
  SelectorLimits selector(int thread_count) const {
    return {pyramid.width_max >> kFeatureLevel,
            pyramid.height_max >> kFeatureLevel,
            explained_max(),
            candidates_max(),
            kHypothesesMax,
            thread_count};
  }
};

// Levels of the pyramid that a detector of these models makes.
int pyramid_level_count(std::span<const ObjectModel> models);

// All models must share one normal codebook (asserted; the programs check it when they load
// models).
DetectorPlan make_detector_plan(std::span<const ObjectModel> models, const DetectorLimits& limits,
                                int thread_count);

// The part of the frame to work on: the region of interest and a margin, aligned to the coarsest
// level's pixels. Errors as Detector::detect states.
Result<Roi> region_of(const Frame& frame, const DetectorPlan& plan);

// Whether the part's centre projects into the region of interest, or into the image where there is
// none: of a part with its centre outside most cannot be seen. `T_cam_centre` is in the cropped
// region's camera.
bool centre_inside_roi(const Frame& frame, const Roi& region, const Pose& T_cam_centre,
                       const Scene& scene);

}  // namespace binpick
