#include "eval/fault_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "overlay/overlay.hpp"

namespace binpick::app {
namespace {

constexpr double kWindowDiameters = 1.5;
constexpr int kSidePxMin = 48;

// What is drawn of a fault: the poses, and where they are.
struct Scene {
  drivers::FrameId frame;
  std::vector<OverlayItem> items;
  Vec3 centre_mm;
  std::string caption;
};

Scene scene_of(const Fault& fault, const EvalPlan& plan, const PartLibrary& library,
               const std::vector<ResultRow>& rows) {
  Scene s;
  const train::Mesh& mesh = library.at(fault.part->obj_id).imported.mesh;
  const auto truth_of = [&](int instance) {
    return plan.truth.at(s.frame)[static_cast<std::size_t>(instance)].truth.T_cam_obj;
  };
  if (fault.missed) {
    const TargetFinding& t = *fault.missed->target;
    const ReferenceFinding& f = t.finding;
    s.frame = t.frame;
    const Pose truth = truth_of(t.instance);
    s.centre_mm = truth.t_mm;
    s.items.push_back({truth, &mesh, std::nullopt, "", OverlayStyle::kMiss});
    if (f.has_owner && t.owner.silhouette_px > 0) {
      s.items.push_back({f.owner.T_cam_obj, &mesh, f.owner.score, "", OverlayStyle::kFalsePick});
    }
    s.caption = "missed, " + std::string(loss_name(fault.missed->cause.loss)) + ": " +
                fault.missed->cause.why;
  } else {
    const ResultRow& row = rows[fault.wrong->row_index];
    s.frame = row.frame;
    s.centre_mm = row.T_cam_obj.t_mm;
    s.items.push_back({row.T_cam_obj, &mesh, row.score, "", OverlayStyle::kFalsePick});
    if (fault.wrong->instance >= 0)
      s.items.push_back(
          {truth_of(fault.wrong->instance), &mesh, std::nullopt, "", OverlayStyle::kMiss});
    s.caption = "false pick, " + false_pick_text(*fault.wrong, plan.truth.at(s.frame));
  }
  s.caption = fault.part->name + ", image " + std::to_string(s.frame.scene_id) + "/" +
              std::to_string(s.frame.im_id) + ": " + s.caption;
  return s;
}

Roi window_around(const CameraIntrinsics& camera, const Vec3& centre_mm, double diameter_mm) {
  const Vec2 at = camera.project(centre_mm);
  const double half_mm = kWindowDiameters / 2 * diameter_mm;
  const int half =
      std::max(kSidePxMin / 2, static_cast<int>(std::lround(half_mm * camera.fx / centre_mm.z())));
  Roi roi{static_cast<int>(at.x()) - half, static_cast<int>(at.y()) - half, 2 * half, 2 * half};
  const int right = std::min(roi.x + roi.width, camera.width),
            bottom = std::min(roi.y + roi.height, camera.height);
  roi.x = std::clamp(roi.x, 0, std::max(0, camera.width - 1));
  roi.y = std::clamp(roi.y, 0, std::max(0, camera.height - 1));
  roi.width = std::max(1, right - roi.x);
  roi.height = std::max(1, bottom - roi.y);
  return roi;
}

Picture side_by_side(const Picture& a, const Picture& b) {
  Picture out{a.width + b.width, a.height, {}};
  for (int y = 0; y < a.height; ++y) {
    out.rgb.insert(out.rgb.end(), a.pixel(0, y), a.pixel(0, y) + 3 * a.width);
    out.rgb.insert(out.rgb.end(), b.pixel(0, y), b.pixel(0, y) + 3 * b.width);
  }
  return out;
}

}  // namespace

std::vector<Fault> faults_to_show(const std::vector<PartFaults>& parts, std::size_t count_max) {
  std::vector<Fault> first;
  std::vector<std::vector<Fault>> rest;  // of each part
  for (const PartFaults& p : parts) {
    rest.emplace_back();
    std::set<Loss> losses;
    for (const MissedPart& m : p.missed)
      (losses.insert(m.cause.loss).second ? first : rest.back()).push_back({&p, &m, nullptr});
    std::set<FalsePickKind> kinds;
    for (const FalsePick& w : p.wrong)
      (kinds.insert(w.kind).second ? first : rest.back()).push_back({&p, nullptr, &w});
  }
  // Then the parts in turn.
  for (std::size_t i = 0, size = 0; size != first.size() || i == 0; ++i) {
    size = first.size();
    for (const auto& of_part : rest) {
      if (i < of_part.size()) first.push_back(of_part[i]);
    }
  }
  if (first.size() > count_max) first.resize(count_max);
  return first;
}

std::vector<ReportPicture> fault_pictures(const drivers::BopDataset& dataset, const EvalPlan& plan,
                                          const PartLibrary& library,
                                          const std::vector<PartFaults>& parts,
                                          const std::vector<ResultRow>& rows,
                                          std::size_t count_max) {
  std::vector<ReportPicture> pictures;
  for (const Fault& fault : faults_to_show(parts, count_max)) {
    const Scene scene = scene_of(fault, plan, library, rows);
    drivers::LoadedFrame frame;
    try {
      frame = dataset.load_frame(plan.scenes.at(scene.frame.scene_id), scene.frame.im_id);
    } catch (const drivers::DatasetError&) {
      continue;  // named among the faults of the run
    }
    const Roi window = window_around(frame.camera, scene.centre_mm,
                                     library.at(fault.part->obj_id).model.diameter_mm);
    const Picture plain = background_of(frame.view());
    OverlayPainter painter(frame.camera);
    const Picture drawn = painter.paint(plain, scene.items);
    pictures.push_back({scene.caption, encode_png(side_by_side(crop_to_roi(plain, window, 0),
                                                               crop_to_roi(drawn, window, 0)))});
  }
  return pictures;
}

}  // namespace binpick::app
