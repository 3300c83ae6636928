// A detector with what it lives on: for brackets in small images, where nothing else is said.
#pragma once

#include <utility>
#include <vector>

#include "binpick/base/arena.hpp"
#include "binpick/detect/detector.hpp"
#include "bracket.hpp"
#include "threads_per_call.hpp"

namespace binpick {

struct DetectorRig {
  static constexpr DetectorLimits kLimits{480, 360, 0, 0, 32};

  explicit DetectorRig(const DetectorLimits& limits = kLimits, const DetectorParams& params = {},
                       int threads = 1, ClockFn clock = nullptr,
                       std::vector<ObjectModel> parts = {bracket_model()})
      : pool(threads),
        models(std::move(parts)),
        arena(Detector::footprint(models, limits, params, threads)),
        detector(models, limits, params, pool, clock, arena) {
    arena.seal();
  }

  ThreadsPerCall pool;
  std::vector<ObjectModel> models;
  Arena arena;
  Detector detector;
};

}  // namespace binpick
