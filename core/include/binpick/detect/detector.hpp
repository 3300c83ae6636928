// Finds the poses of trained parts in a frame: feature pyramids, exhaustive scan of the tree's scan
// depth, coarse-to-fine descent on rearranged maps, then alignment, verification and selection of
// the poses (paper section III-D and beyond). Takes all its memory from an arena when it is made;
// detect() allocates nothing, throws nothing and answers the same bits on any number of threads.
// Thread: one detect() at a time.
#pragma once

#include <cstdint>
#include <span>

#include "binpick/base/arena.hpp"
#include "binpick/base/clock.hpp"
#include "binpick/base/result.hpp"
#include "binpick/base/worker_pool.hpp"
#include "binpick/frame/frame.hpp"
#include "binpick/frame/modality.hpp"
#include "binpick/model/object_model.hpp"
#include "binpick/report/detection.hpp"
#include "binpick/search/map_layout.hpp"
#include "binpick/simd/isa.hpp"

namespace binpick {

class StageObserver;

// The largest problem a detector is built for; memory is sized by this.
struct DetectorLimits {
  int image_width = 1280, image_height = 1024;
  int roi_width = 0, roi_height = 0;  // 0: the whole image
  int results_max = 128;
};

struct DetectorParams {
  MapLayout layout = MapLayout::kRearranged;
  Isa isa = Isa::kBest;
};

struct DetectRequest {
  // Which of the detector's models to look for; empty: all.
  std::span<const int> model_indices;
  Modality modality = Modality::kAutomatic;  // which of the frame's images to look at
  NearSymmetry near_symmetry = NearSymmetry::kAuto;
  int max_results = 64;
  double min_score = 0.85;  // probability that the pose is right
  // On the detector's clock: what is verified by then is answered, and the report says cut_short.
  // Late by at most one distance of the scan or a few poses. 0: no deadline. Where it is not
  // reached the answer is the same as without one.
  std::int64_t deadline_ns = 0;
  // Looks on between the stages (diagnosis.hpp); none in the cycle of a station.
  StageObserver* observer = nullptr;
};

class Detector {
 public:
  // Bytes of arena that a detector with these limits takes.
  static std::size_t footprint(std::span<const ObjectModel> models, const DetectorLimits& limits,
                               const DetectorParams& params, int thread_count);

  // `models`, `pool` and the arena outlive the detector.
  Detector(std::span<const ObjectModel> models, const DetectorLimits& limits,
           const DetectorParams& params, WorkerPool& pool, ClockFn clock, Arena& arena);
  ~Detector();
  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;

  // Errors: frame empty or without an image that the request's modality needs, sizes differ or
  // exceed the limits, intrinsics invalid, ROI outside the image, model trained for a camera that
  // re-scaling cannot bridge. A frame whose depth is all invalid is an empty report where depth is
  // looked at.
  Result<DetectionReport> detect(const Frame& frame, const DetectRequest& request) noexcept;

 private:
  struct Impl;
  Impl* impl_;
};

}  // namespace binpick
