#include "eval/oracle_run.hpp"

#include "binpick/geometry/angle.hpp"

namespace binpick::app {
namespace {

struct Target {
  int instance = 0, obj_id = 0, model_index = -1;
  std::vector<Pose> poses;  // that look alike
};

std::vector<Target> targets_of(const OracleRequest& request, const ModelSet& models,
                               const WantedFrame& wanted) {
  std::vector<Target> targets;
  const auto truth = request.plan.truth.find(wanted.id);
  if (truth == request.plan.truth.end()) return targets;
  for (std::size_t i = 0; i < truth->second.size(); ++i) {
    const ScoredInstance& instance = truth->second[i];
    const int obj_id = instance.truth.obj_id;
    const int index = models.index_of(obj_id);
    if (index < 0 || !wanted.objects.contains(obj_id) || !is_target(instance, request.options))
      continue;
    Target target{static_cast<int>(i), obj_id, index, {instance.truth.T_cam_obj}};
    for (const Pose& symmetry : request.geometry.at(obj_id).symmetries())
      target.poses.push_back(instance.truth.T_cam_obj * symmetry);
    targets.push_back(std::move(target));
  }
  return targets;
}

void compare_with_data(const OracleRequest& request, const Frame& frame, const Pose& truth,
                       const ModelSet& models, PoseComparer& comparer, TargetFinding& t) {
  // Depth that was not looked at explains nothing.
  if (frame.depth_mm.empty() || request.search.modality == Modality::kIntensity) return;
  const ReferenceFinding& f = t.finding;
  const train::Mesh& mesh = request.parts.at(t.obj_id).imported.mesh;
  const bool stayed = f.from_truth.right();
  const Pose& best = stayed ? f.from_truth.detection.T_cam_obj : truth;
  t.moved = comparer.compare(frame, mesh, best,
                             f.from_truth.posed ? f.from_truth.detection.T_cam_obj : truth);
  if (!f.has_owner) return;
  // Another kind of part, or one that stands beside, is no other pose of this one.
  const int owner_id = models.origins()[static_cast<std::size_t>(f.owner.model_index)].obj_id;
  const PartGeometry& part = request.geometry.at(t.obj_id);
  const Pose& owner = f.owner.T_cam_obj;
  if (owner_id != t.obj_id || (owner.t_mm - truth.t_mm).norm() > part.diameter_mm() / 2) return;
  for (const ScoredInstance& other : request.plan.truth.at(t.frame)) {
    if (other.truth.obj_id != t.obj_id) continue;
    const PoseError6 error = part.six_errors(owner, other.truth.T_cam_obj, request.options.limits);
    if (relative_error(error, request.options.limits) < 1) return;
  }
  t.owner = comparer.compare(frame, mesh, best, owner);
}

}  // namespace

void run_oracle(const OracleRequest& request, const CameraGroup& group, const ModelSet& models,
                WorkerPool& pool, const EvalTalk& talk, std::vector<TargetFinding>& found,
                std::vector<std::string>& faults) {
  ReferenceLimits limits;
  limits.position_mm = request.options.limits.mm;
  limits.angle_rad = request.options.limits.deg * kDegree;
  PoseComparer comparer;
  const auto look = [&](const FrameVisit& visit) -> Result<int> {
    const std::vector<Target> targets = targets_of(request, models, visit.wanted);
    std::vector<ReferencePose> references;
    for (const Target& t : targets) references.push_back({t.model_index, t.poses});
    std::vector<ReferenceFinding> findings(references.size());
    const Frame frame = visit.frame.view();
    const Result<DetectionReport> report =
        diagnose(visit.detector, frame, visit.request, references, limits, findings);
    if (!report.ok()) return report.error();
    for (std::size_t i = 0; i < targets.size(); ++i) {
      TargetFinding t{visit.wanted.id, targets[i].obj_id, targets[i].instance, findings[i], {}, {}};
      compare_with_data(request, frame, targets[i].poses.front(), models, comparer, t);
      found.push_back(std::move(t));
    }
    return 0;
  };
  visit_frames(request.dataset, request.plan, group, models, request.search, pool, talk,
               "starting at the truth", faults, look);
}

}  // namespace binpick::app
