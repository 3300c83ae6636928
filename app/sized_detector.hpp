// A detector and the memory it lives in, made for one image size.
#pragma once

#include <span>

#include "binpick/base/arena.hpp"
#include "binpick/detect/detector.hpp"
#include "clock.hpp"

namespace binpick::app {

class SizedDetector {
 public:
  // `models` and `pool` outlive it.
  SizedDetector(std::span<const ObjectModel> models, const DetectorLimits& limits,
                const DetectorParams& params, WorkerPool& pool)
      : arena_(Detector::footprint(models, limits, params, pool.thread_count())),
        detector_(models, limits, params, pool, &monotonic_ns, arena_) {
    arena_.seal();
  }

  Detector& detector() { return detector_; }

 private:
  Arena arena_;
  Detector detector_;
};

}  // namespace binpick::app
