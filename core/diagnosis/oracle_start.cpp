#include "diagnosis/oracle_start.hpp"

#include "detect/detection_of.hpp"
#include "diagnosis/nearest_template.hpp"
#include "pose/score_candidates.hpp"
#include "pose/select.hpp"

namespace binpick {
namespace {

class Starter {
 public:
  Starter(const ObservedCycle& cycle, const ReferencePose& reference, const ReferenceLimits& limits,
          Coverage& coverage)
      : cycle_(cycle),
        reference_(reference),
        limits_(limits),
        coverage_(coverage),
        scene_(cycle.pyramid, cycle.kernels.pose),
        model_(cycle.models[static_cast<std::size_t>(reference.model_index)]) {}

  Hypothesis at_truth(const std::optional<Candidate>& leaf) const {
    Hypothesis h;
    if (leaf) h.candidate = *leaf;
    h.candidate.model = static_cast<std::uint8_t>(reference_.model_index);
    h.T_cam_centre = centre_pose();
    return h;
  }

  OracleStart from_truth(const std::optional<Candidate>& leaf) {
    Hypothesis h = at_truth(leaf);
    align_one(context(), fine_alignment(scene_), h);
    return finished(h);
  }

  OracleStart from_template(const std::optional<Candidate>& leaf) {
    if (!leaf) return {};
    Hypothesis h;
    score_candidates(context(), {&*leaf, 1}, cycle_.pyramid, {&h, 1});
    for (const auto& schedule : {coarse_alignment(scene_), fine_alignment(scene_)}) {
      if (h.alive) align_one(context(), schedule, h);
    }
    return finished(h);
  }

  void find_owner(const Hypothesis& known, ReferenceFinding& finding) {
    for (const Hypothesis& h : cycle_.explained) {
      if (!h.alive || is_known(h)) continue;
      const double share = share_covered_by(h, known);
      if (share <= finding.owner_share) continue;
      finding.has_owner = true;
      finding.owner = detection_of(context(), h);
      finding.owner_rank = h.rank;
      finding.owner_share = share;
    }
  }

  // As one of the model's viewpoints shows it.
  Pose centre_pose() const {
    Pose T = reference_.poses.front();
    T.t_mm += T.R * model_.centre_mm();
    return cycle_.symmetries[static_cast<std::size_t>(reference_.model_index)].canonical(
        model_, scene_.kernels, T);
  }

 private:
  PoseContext context() const {
    return {cycle_.models, cycle_.symmetries, scene_, serial_, {}, cycle_.request.near_symmetry};
  }

  double error_of(const Hypothesis& h) const {
    return reference_error(model_, reference_, h.T_cam_centre, limits_.position_mm,
                           limits_.angle_rad);
  }

  bool is_known(const Hypothesis& h) const {
    return h.candidate.model == reference_.model_index && error_of(h) < 1;
  }

  // Share of what `known` explains that `h` explains too.
  double share_covered_by(Hypothesis h, const Hypothesis& known) {
    coverage_.clear(scene_);
    coverage_.add(context(), h);
    return coverage_.covered(context(), known).share;
  }

  // As where the scene is explained, were this the best pose of its place.
  void add_conflicts(Hypothesis& h) {
    coverage_.clear(scene_);
    coverage_.add(context(), h);
    for (Hypothesis o : cycle_.explained) {
      const bool competed = o.alive || o.drop_reason == DropReason::kOverlapsBetter ||
                            o.drop_reason == DropReason::kBelowMinScore;
      if (!competed) continue;
      o.conflict_odds = 0;
      if (coverage_.owner_of(context(), o) != nullptr) add_conflict(context(), o, h);
    }
    h.score = score_of(context(), h);
  }

  OracleStart finished(Hypothesis& h) {
    OracleStart out;
    if (!h.alive) return out;
    verify_one(context(), h);
    out.posed = true;
    out.error = error_of(h);
    out.rank = h.rank;
    add_conflicts(h);
    out.detection = detection_of(context(), h);
    if (const auto objection = objection_to(h, cycle_.request.min_score)) {
      out.objected = true;
      out.objection = *objection;
    }
    coverage_.clear(scene_);
    for (Hypothesis o : cycle_.explained) {
      if (o.alive && o.rank > h.rank && !is_known(o)) coverage_.add(context(), o);
    }
    out.owned_by_better = coverage_.covered(context(), h).share;
    out.outranked = out.owned_by_better > kCoveredShareMax;
    return out;
  }

  const ObservedCycle& cycle_;
  const ReferencePose& reference_;
  const ReferenceLimits& limits_;
  Coverage& coverage_;
  Scene scene_;
  const ObjectModel& model_;
  mutable SerialPool serial_;
};

}  // namespace

void start_from_reference(const ObservedCycle& cycle, const ReferencePose& reference,
                          const ReferenceLimits& limits, Coverage& coverage,
                          ReferenceFinding& finding) {
  Starter starter(cycle, reference, limits, coverage);
  const auto index = static_cast<std::size_t>(reference.model_index);
  const ObjectModel& model = cycle.models[index];
  const TemplateContext context{model, reference.model_index, cycle.plans[index], cycle.pyramid,
                                cycle.kernels};
  std::optional<Candidate> leaf;
  for (int d = model.info().scan_depth; d < model.depth_count(); ++d) {
    leaf = nearest_template(context, d, starter.centre_pose());
    if (leaf) {
      finding.template_scores[static_cast<std::size_t>(d)] =
          static_cast<double>(leaf->score) / kScoreOne;
    }
  }
  finding.from_truth = starter.from_truth(leaf);
  finding.from_template = starter.from_template(leaf);
  starter.find_owner(starter.at_truth(leaf), finding);
}

}  // namespace binpick
