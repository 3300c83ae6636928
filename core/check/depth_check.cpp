#include <algorithm>
#include <cmath>
#include <cstdint>

#include "check/checks.hpp"

namespace binpick {
namespace {

// A frame with less than this of its region measured shows next to nothing.
constexpr double kLittleShare = 0.02;
// A value that so many measured pixels have, and hardly any other pixel comes near to: no surface.
// Within the trained distances it may be a floor that was rendered without noise.
constexpr double kRepeatedShare = 0.02, kNearShare = 0.1;
constexpr double kNearRatio = 0.02;
constexpr double kOneValueShare = 0.995;
// The largest number of a 16-bit image: what sensors and programs write for "not measured".
constexpr float kLargestCode = 65535;
// Less than this of the measured pixels within the trained distances is none.
constexpr double kOverlapShare = 0.005;
// Other than a unit no power of ten explains so many of them.
constexpr double kExplainedShare = 0.5;
constexpr double kUnitFactors[] = {1000, 100, 10, 0.1, 0.01, 0.001};
// Where the trained distances span more, a factor of ten may meet them by chance.
constexpr double kNarrowRange = 3;
// No 3D sensor of a robot cell measures beyond these.
constexpr double kPlausibleMin_mm = 30, kPlausibleMax_mm = 30000;
constexpr double kUsualMin_mm = 200, kUsualMax_mm = 5000;

struct Range {
  double min_mm = 0, max_mm = 0;
  bool has(double depth_mm) const { return depth_mm >= min_mm && depth_mm <= max_mm; }
};

// Of the part's surface: it reaches half a diameter to both sides of where its middle may be.
Range surface_range(const ObjectModel& model) {
  const ModelInfo& info = model.info();
  return {info.distance_min_mm - info.diameter_mm / 2, info.distance_max_mm + info.diameter_mm / 2};
}

double share_within(std::span<const float> values, const Range& range, double factor = 1) {
  const auto begin = std::lower_bound(values.begin(), values.end(), range.min_mm / factor);
  const auto end = std::upper_bound(begin, values.end(), range.max_mm / factor);
  return static_cast<double>(end - begin) / static_cast<double>(values.size());
}

void sample(const Frame& frame, const PixelRange& region, DepthSamples& samples) {
  const int step_x = sample_step(region.x1 - region.x0, DepthSamples::kSide);
  const int step_y = sample_step(region.y1 - region.y0, DepthSamples::kSide);
  int rows = 0;
  for (int y = region.y0 + step_y / 2; y < region.y1; y += step_y) {
    const float* row = frame.depth_mm.row(y);
    for (int x = region.x0 + sample_begin(rows++, step_x); x < region.x1; x += step_x) {
      ++samples.looked_at;
      if (is_measured(row[x]))
        samples.depth_mm[static_cast<std::size_t>(samples.measured++)] = row[x];
    }
  }
  std::sort(samples.depth_mm.begin(), samples.depth_mm.begin() + samples.measured);
}

bool any_measured(const Frame& frame, const PixelRange& region) {
  for (int y = region.y0; y < region.y1; ++y) {
    const float* row = frame.depth_mm.row(y);
    if (std::any_of(row + region.x0, row + region.x1, is_measured)) return true;
  }
  return false;
}

struct Run {
  std::size_t first = 0, count = 0;
};

// The value that most samples have.
Run longest_run(std::span<const float> sorted) {
  Run longest;
  for (std::size_t i = 0; i < sorted.size();) {
    const std::size_t end = static_cast<std::size_t>(
        std::upper_bound(sorted.begin() + static_cast<std::ptrdiff_t>(i), sorted.end(), sorted[i]) -
        sorted.begin());
    if (end - i > longest.count) longest = {i, end - i};
    i = end;
  }
  return longest;
}

bool in_trained_distances(const FrameCheckRequest& request, double depth_mm) {
  bool within = false;
  for_each_wanted(request, [&](const ObjectModel& model, int) {
    within |= surface_range(model).has(depth_mm);
  });
  return within;
}

bool is_largest_code(const Frame& frame, float depth_mm) {
  const auto scale = static_cast<float>(frame.depth_scale_mm);
  return depth_mm == kLargestCode || (scale > 0 && depth_mm == kLargestCode * scale);
}

void remove(const Run& run, DepthSamples& samples) {
  const auto begin = samples.depth_mm.begin() + static_cast<std::ptrdiff_t>(run.first);
  std::copy(begin + static_cast<std::ptrdiff_t>(run.count),
            samples.depth_mm.begin() + samples.measured, begin);
  samples.measured -= static_cast<int>(run.count);
}

void check_repeated_value(const Frame& frame, const FrameCheckRequest& request,
                          DepthSamples& samples, FrameFindings& findings) {
  const std::span<const float> values = samples.values();
  const Run run = longest_run(values);
  const float value = values[run.first];
  const auto count = static_cast<double>(run.count);
  const double share = count / static_cast<double>(values.size());
  const bool is_code = is_largest_code(frame, value);
  const bool trained = in_trained_distances(request, value);
  if (share >= kOneValueShare && !is_code) {
    const bool refuses = !request.models.empty() && !trained;
    findings.add({FindingCode::kDepthAllOneValue, refuses, -1, {value}});
    return;
  }
  const Range near{value * (1 - kNearRatio), value * (1 + kNearRatio)};
  const double beside = share_within(values, near) - share;
  if (share < kRepeatedShare) return;
  if (!is_code && (trained || beside > kNearShare * share)) return;
  const double code = frame.depth_scale_mm > 0 ? std::round(value / frame.depth_scale_mm) : 0;
  findings.add({FindingCode::kDepthRepeatedValue, is_code, -1, {value, share, code}});
  remove(run, samples);
}

// 0: no power of ten explains the depths.
double unit_factor(std::span<const float> values, const Range& range) {
  for (const double factor : kUnitFactors) {
    if (share_within(values, range, factor) >= kExplainedShare) return factor;
  }
  return 0;
}

void check_plausible(const Frame& frame, const DepthSamples& samples, FrameFindings& findings) {
  const double median_mm = samples.quantile(0.5);
  if (median_mm >= kPlausibleMin_mm && median_mm <= kPlausibleMax_mm) return;
  const double factor = unit_factor(samples.values(), {kUsualMin_mm, kUsualMax_mm});
  findings.add(
      {FindingCode::kDepthUnit, true, -1, {median_mm, factor, 0, 0, frame.depth_scale_mm}});
}

void check_trained_distances(const Frame& frame, const FrameCheckRequest& request,
                             const DepthSamples& samples, FrameFindings& findings) {
  const std::span<const float> values = samples.values();
  bool overlaps = false;
  for_each_wanted(request, [&](const ObjectModel& model, int) {
    overlaps |= share_within(values, surface_range(model)) >= kOverlapShare;
  });
  bool unit_named = false;
  for_each_wanted(request, [&](const ObjectModel& model, int index) {
    const Range range = surface_range(model);
    if (unit_named || share_within(values, range) >= kOverlapShare) return;
    const double min_mm = model.info().distance_min_mm, max_mm = model.info().distance_max_mm;
    const double factor = overlaps ? 0 : unit_factor(values, range);
    if (factor == 0) {
      findings.add({FindingCode::kDepthNotTrained,
                    false,
                    index,
                    {samples.quantile(0.05), samples.quantile(0.95), min_mm, max_mm}});
      return;
    }
    const bool by_chance = (factor == 10 || factor == 0.1) && max_mm > kNarrowRange * min_mm;
    findings.add({FindingCode::kDepthUnit,
                  !by_chance,
                  index,
                  {samples.quantile(0.5), factor, min_mm, max_mm, frame.depth_scale_mm}});
    unit_named = true;
  });
}

}  // namespace

double DepthSamples::quantile(double share) const {
  const auto last = static_cast<double>(measured - 1);
  return depth_mm[static_cast<std::size_t>(std::lround(share * last))];
}

void check_depth(const Frame& frame, const PixelRange& region, const FrameCheckRequest& request,
                 DepthSamples& samples, FrameFindings& findings) {
  sample(frame, region, samples);
  if (samples.measured == 0 && !any_measured(frame, region)) {
    findings.add({FindingCode::kNothingMeasured, true});
    return;
  }
  const double share = static_cast<double>(samples.measured) / samples.looked_at;
  if (share < kLittleShare) findings.add({FindingCode::kLittleMeasured, false, -1, {share}});
  if (samples.measured == 0) return;
  check_repeated_value(frame, request, samples, findings);
  if (samples.measured == 0) return;
  if (request.models.empty()) {
    check_plausible(frame, samples, findings);
  } else {
    check_trained_distances(frame, request, samples, findings);
  }
}

}  // namespace binpick
