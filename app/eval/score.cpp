#include "eval/score.hpp"

#include <algorithm>
#include <cmath>

#include "eval/assignment.hpp"

namespace binpick::app {
namespace {

using drivers::FrameId;

// Pairs farther apart than this are not worth comparing.
double neighbourhood_mm(const PartGeometry& part) {
  return std::max(part.diameter_mm(), 15.0);
}

constexpr int kMssdSteps = 10;

// All that is added up over the frames of one part.
struct Tally {
  std::vector<Scored> pose, add10, add15;
  std::vector<std::pair<double, PoseError6>> right_errors;  // with the score
  std::array<int, kMssdSteps> mssd_hits{};
  std::vector<double> times_s;
};

// One frame, one part: the detections, best score first, and the instances near each of them.
struct FrameProblem {
  std::vector<std::size_t> rows;       // indices into all results
  std::vector<std::size_t> instances;  // indices into the frame's truth
  std::vector<bool> target;            // of each of `instances`
};

// error(estimate, pose) of the first `detection_count` detections against the instances near them.
template <class ErrorFn>
PairErrors pair_errors(const PartGeometry& part, const FrameProblem& problem,
                       const std::vector<ResultRow>& rows, const std::vector<ScoredInstance>& truth,
                       std::size_t detection_count, ErrorFn&& error) {
  PairErrors errors(detection_count);
  for (std::size_t d = 0; d < detection_count; ++d) {
    const Pose& estimate = rows[problem.rows[d]].T_cam_obj;
    for (std::size_t i = 0; i < problem.instances.size(); ++i) {
      const Pose& pose = truth[problem.instances[i]].truth.T_cam_obj;
      if ((estimate.t_mm - pose.t_mm).norm() >= neighbourhood_mm(part)) continue;
      errors[d].push_back({static_cast<int>(i), error(estimate, pose)});
    }
  }
  return errors;
}

void append(std::vector<Scored>& list, const FrameProblem& problem,
            const std::vector<ResultRow>& rows, const std::vector<Match>& matches) {
  for (std::size_t d = 0; d < matches.size(); ++d) {
    list.push_back({rows[problem.rows[d]].score, matches[d].verdict});
  }
}

void score_add(const PartGeometry& part, const FrameProblem& problem,
               const std::vector<ResultRow>& rows, const std::vector<ScoredInstance>& truth,
               Tally& tally) {
  const PairErrors errors = pair_errors(
      part, problem, rows, truth, problem.rows.size(),
      [&part](const Pose& estimate, const Pose& pose) { return part.add_mm(estimate, pose); });
  append(tally.add10, problem, rows,
         assign_greedily(errors, problem.target, 0.10 * part.diameter_mm()));
  append(tally.add15, problem, rows,
         assign_greedily(errors, problem.target, 0.15 * part.diameter_mm()));
}

// Looks at no more detections than there are instances that can be seen at all.
void score_mssd(const PartGeometry& part, const FrameProblem& problem,
                const std::vector<ResultRow>& rows, const std::vector<ScoredInstance>& truth,
                Tally& tally) {
  const auto seen =
      std::count_if(problem.instances.begin(), problem.instances.end(),
                    [&](std::size_t i) { return truth[i].truth.visible_fraction >= 0.1; });
  const std::size_t count = std::min(problem.rows.size(), static_cast<std::size_t>(seen));
  const PairErrors errors = pair_errors(
      part, problem, rows, truth, count,
      [&part](const Pose& estimate, const Pose& pose) { return part.mssd_mm(estimate, pose); });
  for (int step = 0; step < kMssdSteps; ++step) {
    const double limit = 0.05 * (step + 1) * part.diameter_mm();
    for (const Match& m : assign_greedily(errors, problem.target, limit)) {
      tally.mssd_hits[step] += m.verdict == Verdict::kRight;
    }
  }
}

void score_frame(const PartGeometry& part, const FrameProblem& problem,
                 const std::vector<ResultRow>& rows, const std::vector<ScoredInstance>& truth,
                 const PoseLimits& limits, Tally& tally, PartScore& score) {
  const auto six = [&](const Pose& estimate, const Pose& pose) {
    return relative_error(part.six_errors(estimate, pose, limits), limits);
  };
  const std::vector<Match> matches = assign_greedily(
      pair_errors(part, problem, rows, truth, problem.rows.size(), six), problem.target, 1.0);
  append(tally.pose, problem, rows, matches);
  for (std::size_t d = 0; d < matches.size(); ++d) {
    const Match& m = matches[d];
    const std::size_t row = problem.rows[d];
    const int instance = m.instance < 0 ? -1 : static_cast<int>(problem.instances[m.instance]);
    score.marks.push_back({row, m.verdict, instance});
    if (m.verdict != Verdict::kRight) continue;
    const Pose& pose = truth[instance].truth.T_cam_obj;
    tally.right_errors.emplace_back(rows[row].score,
                                    part.six_errors(rows[row].T_cam_obj, pose, limits));
  }
  score_add(part, problem, rows, truth, tally);
  score_mssd(part, problem, rows, truth, tally);
}

std::optional<PoseError6> mean_abs_error(const Tally& tally,
                                         const std::optional<double>& threshold) {
  PoseError6 mean{};
  int count = 0;
  for (const auto& [score, error] : tally.right_errors) {
    if (!threshold || score < *threshold) continue;
    for (int i = 0; i < 6; ++i) mean[i] += std::abs(error[i]);
    ++count;
  }
  if (count == 0) return std::nullopt;
  for (double& m : mean) m /= count;
  return mean;
}

void finish(const Tally& tally, const ScoreOptions& options, PartScore& score) {
  score.best = best_over_thresholds(tally.pose, score.instances, &score.curve);
  if (options.fixed_threshold) {
    score.fixed = score_at_threshold(tally.pose, score.instances, *options.fixed_threshold);
  }
  score.mean_abs_error = mean_abs_error(tally, score.best.threshold);
  score.time = summarize_times(tally.times_s);
  const auto add_score = [&](const std::vector<Scored>& list) {
    const ThresholdScore best = best_over_thresholds(list, score.instances, nullptr);
    return AddScore{best.f1, best.recall};
  };
  score.add10 = add_score(tally.add10);
  score.add15 = add_score(tally.add15);
  double hits = 0;
  for (const int h : tally.mssd_hits) hits += h;
  score.mssd_recall = score.instances > 0 ? hits / kMssdSteps / score.instances : 0.0;
}

// Frames of each (mixed scene or none, object), single-kind scenes first.
using Groups = std::map<std::pair<std::optional<int>, int>, std::vector<FrameId>>;

Groups group_frames(const TruthByFrame& truth, const std::set<int>& objects) {
  std::map<int, std::set<int>> kinds;  // of each scene
  for (const auto& [id, instances] : truth) {
    for (const ScoredInstance& i : instances) kinds[id.scene_id].insert(i.truth.obj_id);
  }
  Groups groups;
  for (const auto& [id, instances] : truth) {
    const std::set<int>& of_scene = kinds[id.scene_id];
    for (const int obj_id : of_scene) {
      if (!objects.empty() && !objects.contains(obj_id)) continue;
      groups[{of_scene.size() > 1 ? std::optional<int>(id.scene_id) : std::nullopt, obj_id}]
          .push_back(id);
    }
  }
  return groups;
}

}  // namespace

bool is_target(const ScoredInstance& instance, const ScoreOptions& options) {
  return instance.truth.visible_fraction >= options.visible_min && instance.origin_in_roi;
}

TimeSummary summarize_times(std::vector<double> seconds) {
  TimeSummary summary;
  summary.count = static_cast<int>(seconds.size());
  if (seconds.empty()) return summary;
  std::sort(seconds.begin(), seconds.end());
  const auto percentile = [&seconds](double share) {
    const double position = share * static_cast<double>(seconds.size() - 1);
    const auto below = static_cast<std::size_t>(position);
    const std::size_t above = std::min(below + 1, seconds.size() - 1);
    return seconds[below] +
           (position - static_cast<double>(below)) * (seconds[above] - seconds[below]);
  };
  for (const double s : seconds) summary.mean_s += s;
  summary.mean_s /= static_cast<double>(seconds.size());
  summary.p50_s = percentile(0.50);
  summary.p99_s = percentile(0.99);
  summary.max_s = seconds.back();
  return summary;
}

ScoreReport score_results(const std::map<int, PartGeometry>& geometry, const TruthByFrame& truth,
                          const std::vector<ResultRow>& rows,
                          const std::map<FrameId, double>& time_s, const ScoreOptions& options) {
  std::map<std::pair<FrameId, int>, std::vector<std::size_t>> rows_of;
  for (std::size_t r = 0; r < rows.size(); ++r)
    rows_of[{rows[r].frame, rows[r].obj_id}].push_back(r);

  ScoreReport report;
  report.options = options;
  for (const auto& [key, frames] : group_frames(truth, options.objects)) {
    const auto part = geometry.find(key.second);
    if (part == geometry.end()) {
      throw drivers::DatasetError("the truth holds object " + std::to_string(key.second) +
                                  ", for which models_info.json has no entry");
    }
    PartScore score;
    Tally tally;
    score.obj_id = key.second;
    score.mixed_scene = key.first;
    score.frames = frames;
    for (const FrameId id : frames) {
      const std::vector<ScoredInstance>& instances = truth.at(id);
      FrameProblem problem;
      problem.rows = rows_of[{id, key.second}];
      std::stable_sort(
          problem.rows.begin(), problem.rows.end(),
          [&rows](std::size_t a, std::size_t b) { return rows[a].score > rows[b].score; });
      for (std::size_t i = 0; i < instances.size(); ++i) {
        if (instances[i].truth.obj_id != key.second) continue;
        problem.instances.push_back(i);
        problem.target.push_back(is_target(instances[i], options));
        score.instances += problem.target.back();
      }
      score.detections += static_cast<int>(problem.rows.size());
      if (const auto t = time_s.find(id); t != time_s.end()) tally.times_s.push_back(t->second);
      score_frame(part->second, problem, rows, instances, options.limits, tally, score);
    }
    finish(tally, options, score);
    (key.first ? report.mixed : report.parts).push_back(std::move(score));
  }
  report.mean = mean_of(report.parts);
  report.mixed_mean = mean_of(report.mixed);
  return report;
}

}  // namespace binpick::app
