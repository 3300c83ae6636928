#include "assess/assessment.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "binpick/geometry/angle.hpp"
#include "eval/html_text.hpp"
#include "setup_error.hpp"

namespace binpick::app {
namespace {

// A part that is worth a line: seen so often and so probable, or in most frames and not impossible.
constexpr int kSeenMin = 3;
constexpr double kSeenShare = 0.2, kLikelyScore = 0.2, kSteadyScore = 0.02;
constexpr double kSamePlace = 0.25;      // of the diameter
constexpr int kSpreadPosesMin = 5;       // to measure a standard deviation
constexpr double kTurned = 5 * kDegree;  // what the poses of a still scene do not do together
constexpr double kNoSpread = 1e-9;       // mm and deg: rounding
constexpr double kNotStatic = 0.5;       // share of likely poses that are not found again

std::string frames_text(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " frame" : " frames");
}

class Assessor {
 public:
  Assessor(Collection collection, std::span<const ObjectModel> models,
           const std::vector<std::string>& names, const AssessSettings& settings)
      : in_(std::move(collection)), models_(models), names_(names) {
    out_.settings = settings;
    for (const ObjectModel& model : models)
      same_.emplace_back(model.symmetry(), model.info().diameter_mm, settings.near_symmetry);
    motions_.resize(in_.frames.size());
    for (std::size_t i = 0; i < in_.frames.size(); ++i) used_.insert(static_cast<int>(i));
  }

  Assessment run() {
    check_count("");
    find_motions();
    if (out_.settings.moved) take_out_motion();
    check_count(", with the motion of the scene taken out");
    std::vector<double> times_s;
    for (const AssessedFrame& frame : in_.frames) times_s.push_back(frame.time_s);
    out_.time = summarize_times(times_s);
    out_.frames = static_cast<int>(used_.size());
    out_.reference = in_.frames[static_cast<std::size_t>(in_.reference)].name;
    out_.noise_mm = out_.settings.moved ? 0 : in_.noise_mm;
    tracks_ = find_tracks(in_.observations, same_);
    for (std::size_t m = 0; m < models_.size(); ++m) out_.models.push_back(assess_model(m));
    add_notes();
    return std::move(out_);
  }

 private:
  void check_count(const std::string& when) const {
    const std::size_t count = used_.size();
    if (count >= kAssessFramesMin) return;
    throw SetupError(frames_text(count) + when + ": an assessment takes at least " +
                     std::to_string(kAssessFramesMin) + " of one scene, better " +
                     std::to_string(kAssessFramesGood) + " or more" +
                     (out_.refused.empty() ? "" : " (" + out_.refused.front() + ")"));
  }

  std::vector<Observation> of_frame(int frame) const {
    std::vector<Observation> poses;
    for (const Observation& o : in_.observations)
      if (o.frame == frame) poses.push_back(o);
    return poses;
  }

  // Of a scene that is said to stand still too: to tell where it does not.
  void find_motions() {
    const std::vector<Observation> reference = of_frame(in_.reference);
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      if (static_cast<int>(i) != in_.reference)
        motions_[i] = find_motion(reference, of_frame(static_cast<int>(i)), same_);
    }
  }

  void take_out_motion() {
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      if (static_cast<int>(i) == in_.reference) continue;
      const SceneMotion& m = motions_[i];
      if (m.determined()) {
        out_.motions.push_back({in_.frames[i].name, m});
        continue;
      }
      used_.erase(static_cast<int>(i));
      out_.refused.push_back(
          in_.frames[i].name + ": the motion of the scene cannot be determined: " +
          std::to_string(m.agreeing) + " of " + std::to_string(m.compared) +
          " poses agree with one motion, " + std::to_string(m.next_best) + " with another");
    }
    std::erase_if(in_.observations, [&](const Observation& o) { return !used_.contains(o.frame); });
    for (Observation& o : in_.observations) {
      const Pose back = motions_[static_cast<std::size_t>(o.frame)].motion.inverse();
      o.T_cam_centre = back * o.T_cam_centre;
      Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
      turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = back.R;
      o.covariance = turn * o.covariance * turn.transpose();
    }
  }

  // Frames in which the place of a part is in the region that was searched.
  int frames_in_view(const Vec3& place) const {
    return static_cast<int>(std::ranges::count_if(used_, [&](int frame) {
      const auto i = static_cast<std::size_t>(frame);
      const Vec3 p = out_.settings.moved ? motions_[i].motion * place : place;
      if (!(p.z() > 0)) return false;
      const Vec2 pixel = in_.camera.project(p);
      const PixelRange& r = in_.frames[i].region;
      return pixel.x() >= r.x0 && pixel.x() < r.x1 && pixel.y() >= r.y0 && pixel.y() < r.y1;
    }));
  }

  AssessedPart assess_track(const Track& track) const {
    AssessedPart part;
    part.track = track;
    part.found = static_cast<int>(track.seen.size());
    part.frames = std::max(part.found, frames_in_view(track.mean.t_mm));
    std::vector<double> scores;
    for (const std::size_t i : track.seen) {
      scores.push_back(in_.observations[i].score);
      part.accepted += in_.observations[i].score >= out_.settings.threshold;
    }
    part.median_score = median_of(std::move(scores));
    const SamePose& same = same_[static_cast<std::size_t>(track.model)];
    part.flips = flips_of(track, in_.observations, same);
    if (part.found > 1) part.repeatability = repeatability_of(track, in_.observations, same);
    return part;
  }

  // A part that is at the place in other frames only: another pose of it.
  int same_place(const AssessedPart& part, const std::vector<AssessedPart>& others) const {
    const double limit_mm =
        kSamePlace * same_[static_cast<std::size_t>(part.track.model)].diameter_mm();
    std::set<int> frames;
    for (const std::size_t i : part.track.seen) frames.insert(in_.observations[i].frame);
    for (const AssessedPart& other : others) {
      const bool near = (other.track.mean.t_mm - part.track.mean.t_mm).norm() < limit_mm;
      const bool together = std::ranges::any_of(other.track.seen, [&](std::size_t i) {
        return frames.contains(in_.observations[i].frame);
      });
      if (near && !together) return other.number;
    }
    return 0;
  }

  bool worth_a_line(const AssessedPart& part) const {
    const bool often = part.found >= kSeenMin && part.found >= kSeenShare * part.frames;
    return part.accepted > 0 || (part.steady() && part.median_score >= kSteadyScore) ||
           (often && part.median_score >= kLikelyScore);
  }

  ModelAssessment assess_model(std::size_t model) {
    ModelAssessment out;
    out.name = names_[model];
    std::vector<ScoredPose> poses;
    std::vector<Repeatability> spreads;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      if (static_cast<std::size_t>(tracks_[t].model) != model) continue;
      AssessedPart part = assess_track(tracks_[t]);
      for (const std::size_t i : part.track.seen) {
        const double score = in_.observations[i].score;
        poses.push_back({score, t, part.steady()});
        const auto bin = static_cast<std::size_t>(std::min(score * kScoreBins, kScoreBins - 1.0));
        ++out.scores.all[bin];
        out.scores.found_again[bin] += part.nearly_always();
        if (!worth_a_line(part))
          out.passing_score_max = std::max(out.passing_score_max, score), ++out.passing_poses;
      }
      if (!worth_a_line(part)) continue;
      if (part.steady() && part.found >= kSpreadPosesMin) spreads.push_back(part.repeatability);
      part.number = ++numbered_;
      part.same_place = same_place(part, out.parts);
      out.parts.push_back(std::move(part));
    }
    out.spread = summarize(spreads);
    out.spread_parts = static_cast<int>(spreads.size());
    out.suggested = suggest_threshold(poses, out_.settings.wrong_picks_max);
    out.at_threshold = wrong_picks(poses, out_.settings.threshold);
    out.limits = limits_of(out.parts, model);
    return out;
  }

  PartEvidence evidence_of(const AssessedPart& part) const {
    PartEvidence evidence;
    evidence.number = part.number;
    evidence.low = part.accepted < part.found;
    const double share = 1.0 / std::max(1, part.found - part.accepted);
    for (const std::size_t i : part.track.seen) {
      const Observation& o = in_.observations[i];
      if (o.score >= out_.settings.threshold) continue;
      for (std::size_t k = 0; k < o.terms.size(); ++k) evidence.terms[k] += share * o.terms[k];
      evidence.missing_share += share * o.missing_share;
      evidence.residual_mm += share * o.residual_mm;
    }
    return evidence;
  }

  // Of the parts that the threshold leaves out in some frames.
  std::vector<LimitFinding> limits_of(const std::vector<AssessedPart>& parts,
                                      std::size_t model) const {
    std::vector<ScoreTerms> all;
    for (const Observation& o : in_.observations)
      if (static_cast<std::size_t>(o.model) == model) all.push_back(o.terms);
    const LimitContext context{in_.seen, models_[model].trials(), best_terms(all), out_.noise_mm,
                               out_.settings.threshold};
    std::vector<PartEvidence> weak;
    for (const AssessedPart& part : parts) {
      if (part.accepted_nearly_always()) continue;
      weak.push_back(evidence_of(part));
    }
    return find_limits(weak, context);
  }

  void add_notes() {
    if (out_.frames < kAssessFramesGood)
      out_.notes.push_back("only " + frames_text(used_.size()) +
                           ": all figures are rough; take at least " +
                           std::to_string(kAssessFramesGood));
    note_motion();
    int likely = 0, again = 0;
    double sigma = 0;
    for (const ModelAssessment& model : out_.models) {
      likely += model.at_threshold.poses.count;
      again += model.at_threshold.poses.right;
      for (const double s : model.spread.worst) sigma = std::max(sigma, s);
      if (model.parts.empty()) out_.notes.push_back(model.name + ": nothing was found");
    }
    if (likely > 0 && again < kNotStatic * likely)
      out_.notes.push_back("only " + std::to_string(again) + " of " + std::to_string(likely) +
                           " poses above the threshold belong to parts found in at least half of "
                           "the frames: this does not look like frames of one scene; choose "
                           "those that are with --scenes and --count");
    const bool measured = std::ranges::any_of(
        out_.models, [](const ModelAssessment& model) { return model.spread_parts > 0; });
    if (measured && sigma < kNoSpread)
      out_.notes.push_back(
          "all poses are the same in every frame: these seem to be copies of one frame, which say "
          "nothing of the sensor's noise");
  }

  // Where a scene that is said to stand still did not.
  void note_motion() {
    if (out_.settings.moved) return;
    std::string names;
    double shift_mm = 0, angle_rad = 0;
    int count = 0;
    const auto by_diameter = [](const SamePose& part) { return part.diameter_mm(); };
    const double limit_mm = std::ranges::min_element(same_, {}, by_diameter)->diameter_mm() / 10;
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      const SceneMotion& m = motions_[i];
      if (!m.determined() || (m.shift_mm < limit_mm && m.angle_rad < kTurned)) continue;
      if (count++ == 0) names = in_.frames[i].name;
      shift_mm = std::max(shift_mm, m.shift_mm);
      angle_rad = std::max(angle_rad, m.angle_rad);
    }
    if (count > 0)
      out_.notes.push_back(
          "the scene moved between the frames, by up to " + fixed_digits(shift_mm, 1) + " mm and " +
          fixed_digits(angle_rad / kDegree, 0) + " deg in " +
          frames_text(static_cast<std::size_t>(count)) + " (" + names +
          (count > 1 ? ", ...)" : ")") + ": what follows takes it to stand still; give --moved");
  }

  Collection in_;
  std::span<const ObjectModel> models_;
  const std::vector<std::string>& names_;
  std::vector<SamePose> same_;        // of each model
  std::vector<SceneMotion> motions_;  // of each frame, from the reference
  std::set<int> used_;                // frames
  std::vector<Track> tracks_;
  int numbered_ = 0;
  Assessment out_;
};

}  // namespace

double AssessedPart::found_share() const {
  return static_cast<double>(found) / frames;
}

double AssessedPart::accepted_share() const {
  return static_cast<double>(accepted) / frames;
}

Assessment assess(Collection collection, std::span<const ObjectModel> models,
                  const std::vector<std::string>& names, const AssessSettings& settings) {
  return Assessor(std::move(collection), models, names, settings).run();
}

}  // namespace binpick::app
