#include "eval/eval_plan.hpp"

#include <cmath>

namespace binpick::app {
namespace {

using drivers::DatasetError;
using drivers::FrameId;
using Targets = std::map<FrameId, std::set<int>>;

// The detector re-scales for differences of this size without loss.
bool nearly_same(const CameraIntrinsics& a, const CameraIntrinsics& b) {
  const double tolerance_px = 0.005 * a.fx;
  return std::abs(a.fx - b.fx) < tolerance_px && std::abs(a.fy - b.fy) < tolerance_px &&
         std::abs(a.cx - b.cx) < tolerance_px && std::abs(a.cy - b.cy) < tolerance_px;
}

std::size_t camera_index(const CameraIntrinsics& camera, std::vector<CameraGroup>& groups) {
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (nearly_same(groups[i].camera, camera)) return i;
  }
  groups.push_back({camera, {}});
  return groups.size() - 1;
}

Targets kinds_in_truth(const TruthByFrame& truth) {
  Targets kinds;
  for (const auto& [id, instances] : truth) {
    for (const ScoredInstance& i : instances) kinds[id].insert(i.truth.obj_id);
  }
  return kinds;
}

void plan_scene(const drivers::BopDataset& dataset, int scene_id,
                const std::optional<Targets>& targets, const std::set<int>& objects,
                EvalPlan& plan) {
  const drivers::BopScene& scene = plan.scenes[scene_id] = dataset.scene(scene_id);
  TruthByFrame truth = load_score_truth(dataset, scene);
  const Targets in_truth = kinds_in_truth(truth);
  bool told = !truth.empty() || !objects.empty();
  for (const auto& [im_id, camera] : scene.frames) {
    WantedFrame frame{{scene_id, im_id}, {}, 0};
    if (targets) {
      const auto target = targets->find(frame.id);
      if (target == targets->end()) continue;
      frame.objects = target->second;
      told = told || !frame.objects.empty();
    }
    const auto seen = in_truth.find(frame.id);
    if (frame.objects.empty() && seen != in_truth.end()) frame.objects = seen->second;
    if (frame.objects.empty() && truth.empty()) frame.objects = objects;
    if (!objects.empty()) std::erase_if(frame.objects, [&](int o) { return !objects.contains(o); });
    if (frame.objects.empty()) continue;
    frame.camera_index = camera_index(camera.intrinsics, plan.cameras);
    plan.cameras[frame.camera_index].frames.push_back(plan.frames.size());
    plan.frames.push_back(std::move(frame));
  }
  if (!told) {
    throw DatasetError(scene.path +
                       ": has neither scene_gt.json nor targets that name objects: nothing says "
                       "what to look for; name them with --objects");
  }
  if (targets) std::erase_if(truth, [&](const auto& f) { return !targets->contains(f.first); });
  plan.truth.merge(truth);
}

}  // namespace

std::set<int> EvalPlan::objects() const {
  std::set<int> all;
  for (const WantedFrame& f : frames) all.insert(f.objects.begin(), f.objects.end());
  return all;
}

EvalPlan make_eval_plan(const drivers::BopDataset& dataset, const EvalSelection& selection) {
  std::set<int> scene_ids = selection.scenes;
  if (scene_ids.empty()) scene_ids.insert(dataset.scene_ids().begin(), dataset.scene_ids().end());
  for (const int scene_id : scene_ids) dataset.scene_path(scene_id);  // throws when there is none

  EvalPlan plan;
  const auto targets = drivers::load_targets(dataset);
  for (const int scene_id : scene_ids) {
    try {
      plan_scene(dataset, scene_id, targets, selection.objects, plan);
    } catch (const DatasetError& e) {
      plan.scenes.erase(scene_id);
      plan.faults.emplace_back(e.what());
    }
  }
  if (plan.frames.empty() && plan.faults.empty()) {
    throw DatasetError(dataset.root() +
                       ": none of the frames asked for holds any of the objects asked for");
  }
  return plan;
}

}  // namespace binpick::app
