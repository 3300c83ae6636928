// Where a part ends, the depth jumps and the image has an edge. Along some rows and columns the
// image's gradient beside depth steps is averaged, at the step and at places shifted along the
// line. Registered images have a peak at no shift; others have it elsewhere, or nowhere.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include "check/checks.hpp"

namespace binpick {
namespace {

constexpr int kRows = 128;                    // lines that are looked at along x
constexpr int kBands = 24, kBandColumns = 4;  // and along y: a band's columns share cache lines
constexpr int kColumnStep = 4;
constexpr int kLengthMax = 4096;             // of a line, px
constexpr int kGap = 6;                      // px between the two depths of a step
constexpr float kStep = 0.015f;              // relative to the nearer depth
constexpr int kNear = 2;                     // px around a place in which an edge counts
constexpr int kGradientMax = 30;             // more does not make an edge likelier
constexpr int kShiftStep = 4, kShifts = 41;  // 80 px to both sides
constexpr int kNoShift = kShifts / 2, kReach = kNoShift * kShiftStep;
// A peak is judged by the places 12 to 20 px beside it.
constexpr int kBesideFrom = 3, kBesideTo = 5;
// Of 92 good frames of four sensors and a simulation none came near: the higher of the two peaks at
// no shift was 1.12 at least; where one was below 1.12, no other peak along its axis exceeded 1.21.
constexpr int kStepsMin = 150;
constexpr double kNoPeak = 1.12, kPeak = 1.27;
constexpr double kNoPeakUnrelated = 1.06;
constexpr double kDoubt = 0.5;      // gray levels: less than that is no edge
constexpr double kContrastMin = 4;  // gray levels: with less, edges drown in noise

// The pixels of one row or column side by side.
struct Line {
  std::array<float, kLengthMax> depth_mm;
  std::array<std::uint8_t, kLengthMax> gray;
  std::array<std::int32_t, kLengthMax> step;  // 1: the depth jumps across this place
  std::array<std::uint8_t, kLengthMax> edge;  // the strongest gradient within kNear
  int length = 0;

  void take(const Frame& frame, int x, int y, bool along_x, int count) {
    const float* z = &frame.depth_mm.at(x, y);
    const std::uint8_t* g = &frame.intensity.at(x, y);
    length = count;
    if (along_x) {
      std::copy_n(z, count, depth_mm.begin());
      std::copy_n(g, count, gray.begin());
      return;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      depth_mm[i] = *z;
      gray[i] = *g;
      z += frame.depth_mm.stride;
      g += frame.intensity.stride;
    }
  }
};

void find_steps(Line& line) {
  constexpr float kFarthest = std::numeric_limits<float>::max();
  const float* __restrict z = line.depth_mm.data();
  std::int32_t* __restrict step = line.step.data() + kGap / 2;
  const int places = line.length - kGap;
  for (int i = 0; i < places; ++i) {
    const float a = z[i], b = z[i + kGap];
    const float nearer = a < b ? a : b, farther = a < b ? b : a;
    // What is not measured (0, NaN, infinite) fails one of them.
    const bool jumps = (nearer > 0) & (farther <= kFarthest) & (farther - nearer > kStep * nearer);
    step[i] = jumps ? 1 : 0;
  }
}

void find_edges(Line& line) {
  static_assert(kNear == 2);
  std::array<std::uint8_t, kLengthMax> gradient, of_two;
  const std::uint8_t* __restrict gray = line.gray.data();
  std::uint8_t* __restrict g = gradient.data();
  std::uint8_t* __restrict two = of_two.data();
  std::uint8_t* __restrict edge = line.edge.data();
  const auto larger = [](std::uint8_t a, std::uint8_t b) { return a > b ? a : b; };
  const int last = line.length - 1;
  for (int i = 0; i < last; ++i) {
    const int change = std::abs(gray[i + 1] - gray[i]);
    g[i] = static_cast<std::uint8_t>(change < kGradientMax ? change : kGradientMax);
  }
  for (int i = 0; i < last - 1; ++i) two[i] = larger(g[i], g[i + 1]);
  for (int i = kNear; i < last - kNear; ++i) edge[i] = larger(larger(two[i - 2], two[i]), g[i + 2]);
}

struct Profile {
  std::array<std::int64_t, kShifts> sum{};
  int steps = 0;

  void add(Line& line);
};

void Profile::add(Line& line) {
  const int begin = kReach + kNear, end = line.length - kReach - kNear - 1;
  if (begin >= end) return;
  find_steps(line);
  find_edges(line);
  const std::int32_t* const step = line.step.data();
  const std::int32_t* const last = step + end;
  for (const std::int32_t* at = step + begin; (at = std::find(at, last, 1)) != last;) {
    const std::int32_t* const after = std::find(at, last, 0);
    // One step is seen kGap times; longer is a slope. Its middle counts.
    if (after - at <= 2 * kGap) {
      const std::uint8_t* edge = line.edge.data() + (at - step) + (after - at) / 2 - kReach;
      for (std::size_t s = 0; s < kShifts; ++s) sum[s] += edge[s * kShiftStep];
      ++steps;
    }
    at = after;
  }
}

struct Peak {
  double at_no_shift = 0;  // over what lies beside it
  double elsewhere = 0;
  int shift_px = 0;   // of the latter
  double around = 0;  // gradient beside no shift, on average
};

Peak peak_of(const Profile& profile) {
  Peak peak;
  const auto sum = [&](int s) {
    return static_cast<double>(profile.sum[static_cast<std::size_t>(s)]);
  };
  for (int s = kBesideTo; s < kShifts - kBesideTo; ++s) {
    double beside = 0;
    for (int k = kBesideFrom; k <= kBesideTo; ++k) beside += sum(s - k) + sum(s + k);
    beside /= 2 * (kBesideTo - kBesideFrom + 1);
    const double height = (sum(s) + kDoubt * profile.steps) / (beside + kDoubt * profile.steps);
    const int off = std::abs(s - kNoShift);
    if (off <= 1) peak.at_no_shift = std::max(peak.at_no_shift, height);
    if (off == 0) peak.around = beside / std::max(1, profile.steps);
    if (off > 2 && height > peak.elsewhere) {
      peak.elsewhere = height;
      peak.shift_px = (s - kNoShift) * kShiftStep;
    }
  }
  return peak;
}

// Enough is there to be seen, and no step lies on an edge.
bool is_unrelated(const Profile& profile, const Peak& peak) {
  return profile.steps >= kStepsMin && peak.around >= kContrastMin &&
         peak.at_no_shift < kNoPeakUnrelated;
}

bool is_shifted(const Profile& profile, const Peak& peak) {
  return profile.steps >= kStepsMin && peak.at_no_shift < kNoPeak && peak.elsewhere >= kPeak;
}

}  // namespace

void check_registration(const Frame& frame, const PixelRange& region, FrameFindings& findings) {
  const int width = std::min(region.x1 - region.x0, kLengthMax);
  const int height = std::min(region.y1 - region.y0, kLengthMax);
  Line line;
  Profile along_x, along_y;
  const int step_y = sample_step(height, kRows);
  for (int y = region.y0 + step_y / 2; y < region.y1; y += step_y) {
    line.take(frame, region.x0, y, true, width);
    along_x.add(line);
  }
  const int step_x = std::max(sample_step(width, kBands), kBandColumns * kColumnStep);
  for (int band = region.x0; band < region.x1; band += step_x) {
    const int end = std::min(band + kBandColumns * kColumnStep, region.x1);
    for (int x = band; x < end; x += kColumnStep) {
      line.take(frame, x, region.y0, false, height);
      along_y.add(line);
    }
  }
  const Peak x = peak_of(along_x), y = peak_of(along_y);
  const double shift_x = is_shifted(along_x, x) ? x.shift_px : 0;
  const double shift_y = is_shifted(along_y, y) ? y.shift_px : 0;
  const bool unrelated = is_unrelated(along_x, x) && is_unrelated(along_y, y);
  if (shift_x != 0 || shift_y != 0 || unrelated)
    findings.add({FindingCode::kIntensityNotRegistered, false, -1, {shift_x, shift_y}});
}

}  // namespace binpick
