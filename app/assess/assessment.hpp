// What frames of one scene say about a cell, without truth: how poses repeat, whether they claim
// what they hold, how scores spread, what keeps them low, which threshold to ask for.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "assess/frame_collector.hpp"
#include "assess/pick_threshold.hpp"
#include "assess/repeatability.hpp"
#include "assess/scene_motion.hpp"
#include "assess/score_limits.hpp"
#include "assess/tracks.hpp"
#include "eval/score.hpp"

namespace binpick::app {

inline constexpr int kAssessFramesMin = 5, kAssessFramesGood = 10;
inline constexpr int kScoreBins = 10;

struct AssessSettings {
  double threshold = DetectRequest{}.min_score;
  double wrong_picks_max = 0.01;
  bool moved = false;  // the scene, between the frames
  NearSymmetry near_symmetry = NearSymmetry::kAuto;
};

// One part in the scene.
struct AssessedPart {
  int number = 0;  // from 1, in reports and in the picture
  Track track;
  int frames = 0;               // in which its place was in view
  int found = 0, accepted = 0;  // in how many of them; with the threshold's score
  double median_score = 0;
  int flips = 0;                // poses turned by a near symmetry that counts as none
  int same_place = 0;           // number of a part found at this place in other frames; 0: none
  Repeatability repeatability;  // of count 0 with one pose

  double found_share() const;
  double accepted_share() const;
  bool steady() const { return 2 * found >= frames; }
  bool nearly_always() const { return 10 * found >= 9 * frames; }
  bool accepted_nearly_always() const { return 10 * accepted >= 9 * frames; }
};

struct ScoreHistogram {
  std::array<int, kScoreBins> all{}, found_again{};  // the latter: of parts found nearly always
};

struct ModelAssessment {
  std::string name;
  std::vector<AssessedPart> parts;  // those that may be parts: seen often, or with a score
  int passing_poses = 0;            // the others
  double passing_score_max = 0;
  DirectionSummary spread;  // over steady parts
  int spread_parts = 0;
  ScoreHistogram scores;
  std::optional<WrongPicks> suggested;
  WrongPicks at_threshold;
  std::vector<LimitFinding> limits;
};

struct FrameMotion {
  std::string name;
  SceneMotion motion;  // from the reference
};

struct Assessment {
  AssessSettings settings;
  int frames = 0;  // that were used
  std::string reference;
  TimeSummary time;
  double noise_mm = 0;
  std::vector<FrameMotion> motions;  // of the other frames, where the scene was moved
  std::vector<std::string> refused;  // frames whose motion cannot be determined
  std::vector<std::string> notes;    // what makes the figures doubtful; a sentence each
  std::vector<ModelAssessment> models;
};

// Throws SetupError where there are too few frames.
Assessment assess(Collection collection, std::span<const ObjectModel> models,
                  const std::vector<std::string>& names, const AssessSettings& settings);

}  // namespace binpick::app
