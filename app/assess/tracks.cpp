#include "assess/tracks.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace binpick::app {
namespace {

// Once to find the tracks; again because a track may have taken the pose of a neighbour whose own
// track had not begun.
constexpr int kRounds = 2;

struct Match {
  double distance;
  std::size_t track, observation;
};

class Tracker {
 public:
  Tracker(std::span<const Observation> observations, std::span<const SamePose> parts)
      : observations_(observations), parts_(parts) {
    for (std::size_t i = 0; i < observations.size(); ++i)
      frames_[observations[i].frame].push_back(i);
  }

  std::vector<Track> run() {
    for (int round = 0; round < kRounds; ++round) {
      for (Track& track : tracks_) track.seen.clear();
      for (const auto& [frame, indices] : frames_) add_frame(indices);
      std::erase_if(tracks_, [](const Track& track) { return track.seen.empty(); });
      for (Track& track : tracks_) settle(track);
    }
    std::ranges::stable_sort(
        tracks_, [](const Track& a, const Track& b) { return a.seen.size() > b.seen.size(); });
    return std::move(tracks_);
  }

 private:
  // Nearest pairs first; what is left over begins a track.
  void add_frame(const std::vector<std::size_t>& indices) {
    std::vector<Match> matches;
    for (const std::size_t i : indices) {
      const Observation& o = observations_[i];
      const SamePose& part = parts_[static_cast<std::size_t>(o.model)];
      for (std::size_t t = 0; t < tracks_.size(); ++t) {
        if (tracks_[t].model != o.model) continue;
        const double distance = part.distance(o.T_cam_centre, tracks_[t].mean);
        if (distance < 1) matches.push_back({distance, t, i});
      }
    }
    std::ranges::sort(
        matches, {}, [](const Match& m) { return std::tuple(m.distance, m.track, m.observation); });
    std::vector<bool> track_taken(tracks_.size());
    std::map<std::size_t, bool> placed;
    for (const Match& m : matches) {
      if (track_taken[m.track] || placed[m.observation]) continue;
      track_taken[m.track] = placed[m.observation] = true;
      tracks_[m.track].seen.push_back(m.observation);
    }
    for (const std::size_t i : indices) {
      if (!placed[i])
        tracks_.push_back({observations_[i].model, observations_[i].T_cam_centre, {i}, {}});
    }
  }

  // The mean, about the most probable of its poses.
  void settle(Track& track) const {
    const auto score = [&](std::size_t i) { return observations_[i].score; };
    const SamePose& part = parts_[static_cast<std::size_t>(track.model)];
    track.mean = observations_[*std::ranges::max_element(track.seen, {}, score)].T_cam_centre;
    track.poses.clear();
    for (const std::size_t i : track.seen)
      track.poses.push_back(part.nearest(observations_[i].T_cam_centre, track.mean));
    track.mean = mean_pose(track.poses);
  }

  std::span<const Observation> observations_;
  std::span<const SamePose> parts_;
  std::map<int, std::vector<std::size_t>> frames_;
  std::vector<Track> tracks_;
};

}  // namespace

Pose mean_pose(std::span<const Pose> poses) {
  const auto count = static_cast<double>(poses.size());
  Pose mean = poses.front();
  mean.t_mm.setZero();
  for (const Pose& pose : poses) mean.t_mm += pose.t_mm / count;
  for (int i = 0; i < 5; ++i) {  // converges quadratically
    Vec3 step = Vec3::Zero();
    for (const Pose& pose : poses) step += rotation_vector(pose.R * mean.R.transpose()) / count;
    mean.R = orthonormalized(rotation_from_vector(step) * mean.R);
  }
  return mean;
}

std::vector<Track> find_tracks(std::span<const Observation> observations,
                               std::span<const SamePose> parts) {
  return Tracker(observations, parts).run();
}

int flips_of(const Track& track, std::span<const Observation> observations, const SamePose& part) {
  const auto flipped = std::ranges::count_if(track.seen, [&](std::size_t i) {
    return part.flipped(observations[i].T_cam_centre, track.mean);
  });
  const auto count = static_cast<int>(flipped);
  return std::min(count, static_cast<int>(track.seen.size()) - count);
}

}  // namespace binpick::app
