#include "detect/oracle_start.hpp"

#include "detect/acceptance.hpp"
#include "detect/nearest_template.hpp"
#include "pose/rivals.hpp"
#include "pose/screen.hpp"

namespace binpick {
namespace {

class Starter {
 public:
  Starter(const ObservedCycle& cycle, const ReferencePose& reference, const ReferenceLimits& limits,
          SceneOwnership& ownership)
      : cycle_(cycle),
        reference_(reference),
        limits_(limits),
        ownership_(ownership),
        scene_(cycle.pyramid),
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
    run_refine(context(), {&h, 1});
    return finished(h);
  }

  OracleStart from_template(const std::optional<Candidate>& leaf) {
    if (!leaf) return {};
    Hypothesis scratch, h;
    DetectionReport counts;
    if (screen_candidates(context(), {&*leaf, 1}, cycle_.pyramid, {&scratch, 1}, {&h, 1}, counts) ==
        0) {
      return {};
    }
    run_pnp(context(), {&h, 1});
    run_icp(context(), {&h, 1});
    run_refine(context(), {&h, 1});
    return finished(h);
  }

  void find_rival(const Hypothesis& known, ReferenceFinding& finding) {
    for (const Hypothesis& h : cycle_.explained) {
      if (!h.alive || is_known(h)) continue;
      const double share = share_owned_by({&h, 1}, known);
      if (share <= finding.rival_share) continue;
      finding.has_rival = true;
      finding.rival = detection_of(cycle_.models, scene_, h);
      finding.rival_rank = h.rank;
      finding.rival_share = share;
    }
  }

  // As one of the model's viewpoints shows it.
  Pose centre_pose() const {
    Pose T = reference_.poses.front();
    T.t_mm += T.R * model_.centre_mm();
    return cycle_.moves[static_cast<std::size_t>(reference_.model_index)].canonical(model_, T);
  }

 private:
  PoseContext context() const { return {cycle_.models, cycle_.moves, scene_, serial_, {}}; }

  double error_of(const Hypothesis& h) const {
    return reference_error(model_, reference_, h.T_cam_centre, limits_.position_mm,
                           limits_.angle_rad);
  }

  bool is_known(const Hypothesis& h) const {
    return h.candidate.model == reference_.model_index && error_of(h) < 1;
  }

  // Share of what `h` explains that the living ones of `others` explain too.
  double share_owned_by(std::span<const Hypothesis> others, const Hypothesis& h) {
    ownership_.clear(scene_);
    for (const Hypothesis& o : others) {
      if (o.alive) ownership_.claim(cycle_.models[o.candidate.model], scene_, o.T_cam_centre, 0);
    }
    return ownership_.owned(model_, scene_, h.T_cam_centre).share;
  }

  // As where the scene is explained, were this the best pose of its place.
  void meet_rivals(Hypothesis& h) {
    ownership_.clear(scene_);
    ownership_.claim(model_, scene_, h.T_cam_centre, 0);
    for (Hypothesis o : cycle_.explained) {
      const bool competed = o.alive || o.drop_reason == DropReason::kOverlapsBetter ||
                            o.drop_reason == DropReason::kBelowMinScore;
      if (!competed) continue;
      o.rival_odds = 0;
      const ObjectModel& model = cycle_.models[o.candidate.model];
      if (ownership_.owned(model, scene_, o.T_cam_centre).share > kOwnedShareMax)
        meet_rival(context(), h, o);
    }
    score_beside_rivals(context(), h);
  }

  OracleStart finished(Hypothesis& h) {
    OracleStart out;
    if (!h.alive) return out;
    run_verify(context(), {&h, 1});
    out.posed = true;
    out.error = error_of(h);
    out.rank = h.rank;
    meet_rivals(h);
    out.detection = detection_of(cycle_.models, scene_, h);
    if (const auto objection = objection_to(h, cycle_.request.min_score)) {
      out.objected = true;
      out.objection = *objection;
    }
    ownership_.clear(scene_);
    for (const Hypothesis& o : cycle_.explained) {
      if (o.alive && o.rank > h.rank && !is_known(o))
        ownership_.claim(cycle_.models[o.candidate.model], scene_, o.T_cam_centre, 0);
    }
    out.owned_by_better = ownership_.owned(model_, scene_, h.T_cam_centre).share;
    out.outranked = out.owned_by_better > kOwnedShareMax;
    return out;
  }

  const ObservedCycle& cycle_;
  const ReferencePose& reference_;
  const ReferenceLimits& limits_;
  SceneOwnership& ownership_;
  Scene scene_;
  const ObjectModel& model_;
  mutable SerialPool serial_;
};

}  // namespace

void start_from_reference(const ObservedCycle& cycle, const ReferencePose& reference,
                          const ReferenceLimits& limits, SceneOwnership& ownership,
                          ReferenceFinding& finding) {
  Starter starter(cycle, reference, limits, ownership);
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
  starter.find_rival(starter.at_truth(leaf), finding);
}

}  // namespace binpick
