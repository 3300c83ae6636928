#include "eval/report_pictures.hpp"

#include "eval/worst_frames.hpp"
#include "overlay/overlay.hpp"

namespace binpick::app {
namespace {

// Without the two lowest bits, which are the sensor's noise and most of what a PNG has to carry.
Picture without_noise(Picture picture) {
  for (std::uint8_t& v : picture.rgb) v &= 0xfc;
  return picture;
}

}  // namespace

std::vector<ReportPicture> worst_pictures(const drivers::BopDataset& dataset, const EvalPlan& plan,
                                          const PartLibrary& parts, const ScoreReport& score,
                                          const std::vector<ResultRow>& rows,
                                          std::size_t count_max) {
  constexpr int kMargin_px = 40;
  std::vector<ReportPicture> pictures;
  for (const FrameOutcome& outcome : worst_frames(score, plan.truth, rows, count_max)) {
    drivers::LoadedFrame frame;
    try {
      frame = dataset.load_frame(plan.scenes.at(outcome.frame.scene_id), outcome.frame.im_id);
    } catch (const drivers::DatasetError&) {
      continue;  // everything in it counts as missed; the report names it among the faults
    }
    const train::Mesh& mesh = parts.at(outcome.part->obj_id).imported.mesh;
    OverlayPainter painter(frame.camera);
    const Picture picture = painter.paint(without_noise(background_of(frame.view())),
                                          overlay_items(outcome, plan.truth, rows, mesh));
    pictures.push_back({caption(outcome), encode_png(crop_to_roi(picture, frame.roi, kMargin_px))});
  }
  return pictures;
}

}  // namespace binpick::app
