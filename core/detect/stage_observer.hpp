// Looks on while a detection runs, stage by stage; see search_observer.hpp.
#pragma once

#include <span>

#include "binpick/detect/checkpoint.hpp"
#include "binpick/detect/detector.hpp"
#include "pose/hypothesis.hpp"
#include "search/scale_plan.hpp"
#include "search/search_observer.hpp"
#include "simd/kernel_table.hpp"

namespace binpick {

// A detection that has just ended, with all that it worked on.
struct ObservedCycle {
  const Frame& frame;
  const DetectRequest& request;
  const DetectionReport& report;
  std::span<const ObjectModel> models;
  std::span<const SymmetryTransforms> symmetries;  // of the models
  std::span<const ScalePlan> plans;                // one per model; of those that were asked for
  const FeaturePyramid& pyramid;
  const simd::KernelTable& kernels;
  std::span<const Hypothesis> explained;  // best rank first; alive: became a detection
};

class StageObserver : public SearchObserver {
 public:
  virtual void hypotheses(Checkpoint checkpoint, std::span<const Hypothesis> hypotheses) = 0;
  virtual void finished(const ObservedCycle& cycle) = 0;

 protected:
  ~StageObserver() = default;
};

}  // namespace binpick
