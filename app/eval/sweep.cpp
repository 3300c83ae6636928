#include "eval/sweep.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "eval/run_summary.hpp"

namespace binpick::app {
namespace {

constexpr int kVisibleSteps = 10;

std::uint64_t seed_of(const drivers::FrameId& id, Disturbance what) {
  return static_cast<std::uint64_t>(id.scene_id) * 1000003 +
         static_cast<std::uint64_t>(id.im_id) * 101 + static_cast<std::uint64_t>(what);
}

double mean_distance_mm(const drivers::LoadedFrame& frame) {
  double sum = 0;
  std::size_t count = 0;
  for (const float z : frame.depth_mm) {
    if (!(z > 0)) continue;
    sum += static_cast<double>(z);
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

std::vector<const PartScore*> all_parts(const ScoreReport& report) {
  std::vector<const PartScore*> parts;
  for (const auto* list : {&report.parts, &report.mixed}) {
    for (const PartScore& p : *list) parts.push_back(&p);
  }
  return parts;
}

struct Mean {
  double sum = 0;
  int count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
};

void add_point(SweepCurves& curves, double level, const ScoreReport& report) {
  const auto parts = all_parts(report);
  if (curves.parts.empty()) {
    for (const PartScore* p : parts) curves.parts.push_back({part_name(*p), {}, {}});
    for (const char* name : {"F1", "precision", "recall"}) curves.means.push_back({name, {}, {}});
  }
  Mean f1, precision, recall;
  for (std::size_t i = 0; i < parts.size() && i < curves.parts.size(); ++i) {
    curves.parts[i].x.push_back(level);
    curves.parts[i].y.push_back(parts[i]->best.f1);
    const ThresholdScore fixed = parts[i]->fixed.value_or(ThresholdScore{});
    f1.add(fixed.f1);
    recall.add(fixed.recall);
    if (fixed.judged > 0) precision.add(fixed.precision);
  }
  const Mean* const means[] = {&f1, &precision, &recall};
  for (std::size_t k = 0; k < std::size(means); ++k) {
    if (means[k]->count == 0) continue;
    curves.means[k].x.push_back(level);
    curves.means[k].y.push_back(means[k]->sum / means[k]->count);
  }
}

}  // namespace

const std::vector<double>& sweep_levels(Disturbance d) {
  static const std::array<std::vector<double>, kDisturbanceCount> kLevels{{
      {1, 2, 3, 4, 6, 8},
      {0, 0.1, 0.2, 0.3, 0.45, 0.6},
      {1, 0.5, 0.25, 0.12, 0.06},
      {0, 30, 60, 80},
      {0, 0.25, 0.5, 1, 2},
      {0, 2, 4, 8, 16},
  }};
  return kLevels[static_cast<std::size_t>(d)];
}

std::vector<Disturbance> parse_disturbances(const std::string& list) {
  std::vector<Disturbance> found;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string word = list.substr(begin, end - begin);
    bool known = false;
    for (int i = 0; i < kDisturbanceCount; ++i) {
      const auto d = static_cast<Disturbance>(i);
      if (word != "all" && word != disturbance_name(d)) continue;
      known = true;
      if (std::find(found.begin(), found.end(), d) == found.end()) found.push_back(d);
    }
    if (!known) throw std::invalid_argument(word);
    begin = end + 1;
  }
  return found;
}

Sweep::Sweep(const std::vector<Disturbance>& what) {
  for (const Disturbance d : what) {
    const std::vector<double>& levels = sweep_levels(d);
    for (std::size_t i = 1; i < levels.size(); ++i) points_.push_back({d, levels[i], {}});
  }
}

void Sweep::run_group(const drivers::BopDataset& dataset, const EvalPlan& plan,
                      const CameraGroup& group, const ModelSet& models,
                      const EvalSettings& settings, WorkerPool& pool, const EvalTalk& talk) {
  bool first_of_noise = true;
  for (SweepPoint& point : points_) {
    EvalSettings disturbed = settings;
    const bool measure = point.what == Disturbance::kNoise && first_of_noise;
    disturbed.disturb = [&](const drivers::FrameId& id, drivers::LoadedFrame& frame) {
      if (measure) {
        const double z = mean_distance_mm(frame);
        noise_sum_mm_ += depth_noise_share(frame) * z * z;
        ++frames_;
      }
      disturb(frame, point.what, point.level, seed_of(id, point.what));
    };
    if (measure) first_of_noise = false;
    EvalTalk named = talk;
    const std::string label = std::string("sweep: ") + disturbance_name(point.what);
    if (talk.progress)
      named.progress = [&](const std::string&, double share) { talk.progress(label, share); };
    binpick::app::run_group(dataset, plan, group, models, disturbed, pool, named, {}, point.run);
  }
}

std::vector<SweepCurves> score_sweep(const Sweep& sweep, const ScoreReport& undisturbed,
                                     const std::map<int, PartGeometry>& geometry,
                                     const TruthByFrame& truth) {
  std::vector<SweepCurves> all;
  for (const SweepPoint& point : sweep.points()) {
    const std::string name = disturbance_name(point.what);
    if (all.empty() || all.back().name != name) {
      all.push_back({name, disturbance_unit(point.what), "F1", {}, {}});
      add_point(all.back(), sweep_levels(point.what).front(), undisturbed);
    }
    add_point(all.back(), point.level,
              score_results(geometry, truth, point.run.rows, {}, undisturbed.options));
  }
  return all;
}

SweepCurves threshold_curves(const ScoreReport& score) {
  SweepCurves out{"threshold", "threshold", "F1", {}, {}};
  for (const PartScore* p : all_parts(score)) {
    Curve curve{part_name(*p), {}, {}};
    for (auto it = p->curve.rbegin(); it != p->curve.rend(); ++it) {
      const double sum = it->precision + it->recall;
      curve.x.push_back(it->threshold);
      curve.y.push_back(sum > 0 ? 2 * it->precision * it->recall / sum : 0);
    }
    out.parts.push_back(std::move(curve));
  }
  return out;
}

SweepCurves visibility_curves(const ScoreReport& score, const TruthByFrame& truth,
                              const std::vector<ResultRow>& rows) {
  SweepCurves out{"visible", "visible share of the part", "share found", {}, {}};
  for (const PartScore* p : all_parts(score)) {
    std::array<int, kVisibleSteps> all{}, found{};
    const auto step_of = [&](const ScoredInstance& i) {
      return std::clamp(static_cast<int>(i.truth.visible_fraction * kVisibleSteps), 0,
                        kVisibleSteps - 1);
    };
    for (const drivers::FrameId& id : p->frames) {
      for (const ScoredInstance& i : truth.at(id)) {
        if (i.truth.obj_id == p->obj_id && i.origin_in_roi)
          ++all[static_cast<std::size_t>(step_of(i))];
      }
    }
    for (const DetectionMark& mark : p->marks) {
      const ResultRow& row = rows[mark.row_index];
      if (mark.instance < 0 || row.score < p->best.threshold.value_or(0)) continue;
      const ScoredInstance& i = truth.at(row.frame)[static_cast<std::size_t>(mark.instance)];
      if (i.origin_in_roi) ++found[static_cast<std::size_t>(step_of(i))];
    }
    Curve curve{part_name(*p), {}, {}};
    for (int i = 0; i < kVisibleSteps; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (all[at] == 0) continue;
      curve.x.push_back((i + 0.5) / kVisibleSteps);
      curve.y.push_back(static_cast<double>(found[at]) / all[at]);
    }
    out.parts.push_back(std::move(curve));
  }
  return out;
}

}  // namespace binpick::app
