#include "cli/model_summary.hpp"

#include <algorithm>

namespace binpick::app {
namespace {

template <class Items, class Count>
CountSummary summarize(const Items& items, Count count) {
  if (items.empty()) return {};
  CountSummary summary{count(items[0]), count(items[0]), 0};
  double sum = 0;
  for (const auto& item : items) {
    const int n = count(item);
    summary.min = std::min(summary.min, n);
    summary.max = std::max(summary.max, n);
    sum += n;
  }
  summary.mean = sum / static_cast<double>(items.size());
  return summary;
}

}  // namespace

std::vector<DepthSummary> summarize_depths(const ObjectModel& model) {
  std::vector<DepthSummary> summaries;
  for (int d = 0; d < model.depth_count(); ++d) {
    const TreeDepth& depth = model.depth(d);
    DepthSummary summary;
    summary.viewpoints = static_cast<int>(depth.viewpoints.size());
    summary.rolls = depth.roll_count;
    summary.distances = depth.distance_count;
    summary.templates = depth.templates.size();
    summary.features = summarize(depth.templates, [](const TemplateRange& t) { return t.count; });
    summary.children =
        summarize(depth.viewpoints, [](const Viewpoint& v) { return v.child_count; });
    summaries.push_back(summary);
  }
  return summaries;
}

const char* codebook_name(NormalCodebook codebook) {
  switch (codebook) {
    case NormalCodebook::kAzimuth:
      return "azimuth";
    case NormalCodebook::kHemisphere:
      return "hemisphere";
  }
  return "unknown";
}

const char* unit_name(int source_unit) {
  constexpr const char* kNames[] = {"unknown", "mm", "m",  "inch",
                                    "cm",      "ft", "um", "the file's own"};
  return source_unit >= 0 && source_unit < 8 ? kNames[source_unit] : "unknown";
}

}  // namespace binpick::app
