#include "eval/score_truth.hpp"

namespace binpick::app {

bool origin_inside(const CameraIntrinsics& camera, const Roi& roi, const Pose& T_cam_obj) {
  if (roi.whole_image()) return true;
  const Vec2 pixel = camera.project(T_cam_obj.t_mm);
  return roi.x <= pixel.x() && pixel.x() < roi.x + roi.width && roi.y <= pixel.y() &&
         pixel.y() < roi.y + roi.height;
}

TruthByFrame load_score_truth(const drivers::BopDataset& dataset, const drivers::BopScene& scene) {
  TruthByFrame frames;
  for (const auto& [im_id, instances] : drivers::load_truth(dataset, scene.scene_id)) {
    const auto camera = scene.frames.find(im_id);
    if (camera == scene.frames.end()) {
      throw drivers::DatasetError(dataset.scene_file(scene.scene_id, "scene_camera") +
                                  ": has no entry for image " + std::to_string(im_id) +
                                  " of scene_gt.json");
    }
    std::vector<ScoredInstance>& list = frames[{scene.scene_id, im_id}];
    for (const drivers::TruthInstance& t : instances) {
      const drivers::FrameCamera& seen_by = camera->second;
      list.push_back({t, origin_inside(seen_by.intrinsics, seen_by.roi, t.T_cam_obj)});
    }
  }
  return frames;
}

TruthByFrame load_score_truth(const drivers::BopDataset& dataset, const std::set<int>& scene_ids) {
  TruthByFrame frames;
  const auto targets = drivers::load_targets(dataset);
  for (const int scene_id : scene_ids) {
    TruthByFrame scene_frames = load_score_truth(dataset, dataset.scene(scene_id));
    if (targets)
      std::erase_if(scene_frames, [&](const auto& f) { return !targets->contains(f.first); });
    frames.merge(scene_frames);
  }
  return frames;
}

}  // namespace binpick::app
