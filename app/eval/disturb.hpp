// Makes a frame in memory worse, as sensors, light and calibration do; the same seed gives the same
// frame. Thread: any.
#pragma once

#include <cstdint>

#include "binpick/drivers/loaded_frame.hpp"

namespace binpick::app {

enum class Disturbance : int {
  // Depth noise, as a multiple of what the frame has (depth_noise_share): level 1 is the frame as
  // it is, level k adds to it up to k times that. The same for each block of 2x2 px, which is what
  // the detector averages over, and growing with the square of the distance.
  kNoise = 0,
  // Share of the measured pixels inside the ROI that lose their depth, in round blobs of 3 to 16 px
  // radius, as on shiny parts.
  kMissing,
  // Contrast of the intensity image around its mean, as a factor.
  kContrast,
  // Angle in degrees between the light and the optical axis, from a side that the seed chooses. The
  // image is shaded anew from the measured normals as matt surfaces would be, taking the light that
  // it was taken with for one beside the camera; no shadows are cast.
  kLight,
  // Error of the focal lengths that the detector is told, in percent.
  kFocal,
  // Error of the principal point that the detector is told, in px, in a direction that the seed
  // chooses.
  kCentre,
};
inline constexpr int kDisturbanceCount = 6;
const char* disturbance_name(Disturbance d);  // one lower-case word
const char* disturbance_unit(Disturbance d);  // what a level counts, for axes

void disturb(drivers::LoadedFrame& frame, Disturbance what, double level, std::uint64_t seed);

// Standard deviation of the depth in mm per mm^2 of squared distance, from second differences over
// a few pixels, by the median: edges do not count. At least that of the depth image's steps.
double depth_noise_share(const drivers::LoadedFrame& frame);

}  // namespace binpick::app
