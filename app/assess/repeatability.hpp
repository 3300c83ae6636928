// How far the poses of one part scatter from frame to frame, and how far they claim to.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "assess/tracks.hpp"

namespace binpick::app {

// Along camera x, y, z in mm, then about them in degrees.
inline constexpr int kDirectionCount = 6;
inline constexpr const char* kDirectionNames[kDirectionCount] = {"x mm",   "y mm",   "z mm",
                                                                 "rx deg", "ry deg", "rz deg"};

struct Repeatability {
  int count = 0;                                  // poses
  std::array<double, kDirectionCount> sigma{};    // standard deviation about the mean pose
  std::array<double, kDirectionCount> claimed{};  // root of the mean claimed variance
  // Rotations that no pose can tell, because the part has that axis: their sigma says nothing.
  std::array<bool, kDirectionCount> unobservable{};

  // Claimed over measured; 0 where either says nothing.
  double claim(int direction) const;
};

// Of at least two poses.
Repeatability repeatability_of(const Track& track, std::span<const Observation> observations,
                               const SamePose& part);

// Over several parts, direction by direction.
struct DirectionSummary {
  std::array<double, kDirectionCount> median{}, worst{};
  std::array<double, kDirectionCount> claim{};  // median of claimed over measured; 0: none
};
DirectionSummary summarize(std::span<const Repeatability> parts);

double median_of(std::vector<double> values);  // of none: 0

}  // namespace binpick::app
