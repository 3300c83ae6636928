// Which features of a template a frame can show.
#pragma once

#include <algorithm>
#include <span>

#include "binpick/model/object_model.hpp"
#include "features/pyramid.hpp"

namespace binpick {

// Training puts features with a gradient first; without depth the others would match nothing.
inline std::span<const Feature> matched_features(const ObjectModel& model, const TemplateRange& t,
                                                 const FeaturePyramid& pyramid) {
  const std::span<const Feature> all = model.features(t);
  if (pyramid.with_depth()) return all;
  const auto with_gradient = [](const Feature& f) { return f.gradient_bits != 0; };
  const auto end = std::partition_point(all.begin(), all.end(), with_gradient);
  return all.first(static_cast<std::size_t>(end - all.begin()));
}

}  // namespace binpick
