#include "assess/frame_collector.hpp"

#include <algorithm>

#include "clock.hpp"
#include "error_text.hpp"
#include "overlay/overlay.hpp"
#include "setup_error.hpp"

namespace binpick::app {
namespace {

Observation observation_of(const Detection& d, const ObjectModel& model, const Frame& frame,
                           int frame_index) {
  Observation o;
  o.frame = frame_index;
  o.model = d.model_index;
  o.score = d.score;
  o.T_cam_centre = d.T_cam_obj * Pose{Mat3::Identity(), model.centre_mm()};
  o.covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(
      d.uncertainty.covariance.data());
  o.terms = d.score_terms;
  o.residual_mm = d.depth_residual_mm;
  o.missing_share = missing_share(model, frame, o.T_cam_centre);
  return o;
}

Modality seen_in(const Frame& frame) {
  if (frame.depth_mm.empty()) return Modality::kIntensity;
  return frame.intensity.empty() ? Modality::kDepth : Modality::kDepthAndIntensity;
}

bool same_camera(const CameraIntrinsics& a, const CameraIntrinsics& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy &&
         a.cx == b.cx && a.cy == b.cy;
}

}  // namespace

FrameCollector::FrameCollector(std::span<const ObjectModel> models, const DetectRequest& request,
                               const Roi& roi, WorkerPool& pool)
    : models_(models), request_(request), roi_(roi), pool_(pool) {}

Detector& FrameCollector::detector_for(const Frame& frame) {
  const PixelRange region = out_.frames.back().region;
  const int width = region.x1 - region.x0, height = region.y1 - region.y0;
  if (!detector_ || width > width_ || height > height_) {
    width_ = std::max(width_, width), height_ = std::max(height_, height);
    DetectorLimits limits;
    limits.image_width = frame.camera.width;
    limits.image_height = frame.camera.height;
    limits.roi_width = width_;
    limits.roi_height = height_;
    limits.results_max = request_.max_results;
    detector_ = nullptr;  // its memory goes first
    detector_ = std::make_unique<SizedDetector>(models_, limits, DetectorParams{}, pool_);
  }
  return detector_->detector();
}

void FrameCollector::check_camera(const CameraIntrinsics& camera, const std::string& name) {
  if (out_.frames.empty()) out_.camera = camera;
  if (!same_camera(camera, out_.camera))
    throw SetupError(name + ": size or intrinsics differ from those of " +
                     out_.frames.front().name +
                     "; assess frames of one camera, a folder's by --scenes");
}

void FrameCollector::add(Frame frame, const std::string& name) {
  if (!roi_.whole_image()) frame.roi = roi_;
  check_camera(frame.camera, name);
  const Result<Frame> seen = seen_with(frame, request_.modality);
  if (!seen.ok()) throw SetupError(name + ": " + error_text(seen.error()));
  const Modality modality = seen_in(seen.value());
  if (!out_.frames.empty() && modality != out_.seen)
    throw SetupError(name + ": has other images than " + out_.frames.front().name +
                     "; choose those that all have by --modality");
  out_.seen = modality;
  const int index = static_cast<int>(out_.frames.size());
  out_.frames.push_back({name, 0, pixels_of(frame.roi, frame.camera.width, frame.camera.height)});
  Detector& detector = detector_for(frame);
  const std::int64_t begin_ns = monotonic_ns();
  const Result<DetectionReport> report = detector.detect(frame, request_);
  out_.frames.back().time_s = static_cast<double>(monotonic_ns() - begin_ns) * 1e-9;
  if (!report.ok()) throw SetupError(name + ": " + error_text(report.error()));
  double sum = 0;
  for (const Detection& d : report.value().detections) {
    const ObjectModel& model = models_[static_cast<std::size_t>(d.model_index)];
    out_.observations.push_back(observation_of(d, model, seen.value(), index));
    sum += d.score;
  }
  scatter_.add(seen.value());
  if (sum <= best_sum_) return;
  best_sum_ = sum;
  out_.reference = index;
  out_.picture = background_of(frame);
}

Collection FrameCollector::take() {
  out_.noise_mm = scatter_.median_mm();
  return std::move(out_);
}

}  // namespace binpick::app
