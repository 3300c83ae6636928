// What is in a model file, counted: for people and for scripts.
#pragma once

#include <vector>

#include "binpick/model/object_model.hpp"

namespace binpick::app {

struct CountSummary {
  int min = 0, max = 0;
  double mean = 0;
};

struct DepthSummary {
  int viewpoints = 0, rolls = 0, distances = 0;
  std::size_t templates = 0;
  CountSummary features;  // of a template
  CountSummary children;  // of a viewpoint; all 0 at the leaves
};

std::vector<DepthSummary> summarize_depths(const ObjectModel& model);

const char* codebook_name(NormalCodebook codebook);
const char* unit_name(int source_unit);

}  // namespace binpick::app
