// Detections of one part in different frames, told to be the same part by where it lies.
#pragma once

#include <span>
#include <vector>

#include "assess/observation.hpp"
#include "assess/same_pose.hpp"

namespace binpick::app {

struct Track {
  int model = 0;
  Pose mean;                      // of the poses below
  std::vector<std::size_t> seen;  // indices of the observations, by frame; one a frame at most
  std::vector<Pose> poses;        // of these, in the form that is nearest to the mean
};

// The mean of poses that lie near each other.
Pose mean_pose(std::span<const Pose> poses);

// Every observation is in one track; `parts` has an entry for each model. The track that is seen
// most often comes first.
std::vector<Track> find_tracks(std::span<const Observation> observations,
                               std::span<const SamePose> parts);

// In how many frames the pose is the less frequent one of two that a near symmetry makes alike.
int flips_of(const Track& track, std::span<const Observation> observations, const SamePose& part);

}  // namespace binpick::app
