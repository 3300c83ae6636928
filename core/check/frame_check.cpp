#include "binpick/check/frame_check.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "check/checks.hpp"
#include "detect/detector_plan.hpp"
#include "search/scale_plan.hpp"

namespace binpick {
namespace {

constexpr double kBarelyInside = 0.25;  // share of the region that lies in the image
// Of lenses: half the angle of view, and how far off the axis the middle of a cut-out can be.
constexpr double kHalfViewUsual = 60 * kDegree, kHalfViewMax = 75 * kDegree;
constexpr double kOffAxisMax = 60 * kDegree;
constexpr double kNarrowestView = 1 * kDegree;
constexpr double kUnequalFocal = 1.3;
// A principal point farther from the middle than this share of the image's size is another image's.
constexpr double kOffMiddle = 0.4;
constexpr double kPartSideMin_px = 16;

void check_region(const Frame& frame, int width, int height, const PixelRange& inside,
                  FrameFindings& findings) {
  const Roi& roi = frame.roi;
  if (roi.whole_image()) return;
  if (inside.empty()) {
    findings.add({FindingCode::kRoiOutside,
                  true,
                  -1,
                  {double(roi.x), double(roi.y), double(roi.width), double(roi.height),
                   double(width), double(height)}});
    return;
  }
  const double area = static_cast<double>(roi.width) * roi.height;
  const double share = static_cast<double>(inside.x1 - inside.x0) * (inside.y1 - inside.y0) / area;
  if (share < kBarelyInside) findings.add({FindingCode::kRoiBarelyInside, false, -1, {share}});
}

// False: nothing can be said with this camera.
bool check_camera(const CameraIntrinsics& c, int width, int height, FrameFindings& findings) {
  const auto focal = [&](bool refuses, double view_rad) {
    findings.add(
        {FindingCode::kFocalLengthImplausible, refuses, -1, {c.fx, c.fy, view_rad / kDegree}});
  };
  if (!c.valid()) {
    focal(true, 0);
    return false;
  }
  const double half_view = std::max(std::atan(width / (2 * c.fx)), std::atan(height / (2 * c.fy)));
  if (half_view > kHalfViewMax) {
    focal(true, 2 * half_view);
    return false;
  }
  const double unequal = std::max(c.fx, c.fy) / std::min(c.fx, c.fy);
  if (half_view > kHalfViewUsual || 2 * half_view < kNarrowestView || unequal > kUnequalFocal)
    focal(false, 2 * half_view);
  const double off_x = std::abs(c.cx - (width - 1) / 2.0);
  const double off_y = std::abs(c.cy - (height - 1) / 2.0);
  if (off_x > kOffMiddle * width || off_y > kOffMiddle * height) {
    const bool refuses = std::max(off_x / c.fx, off_y / c.fy) > std::tan(kOffAxisMax);
    findings.add({FindingCode::kPrincipalPointOff,
                  refuses,
                  -1,
                  {c.cx, c.cy, double(width), double(height)}});
  }
  return true;
}

// In the frame, of the model at index; `median_mm` of what was measured, 0: nothing.
void check_part_size(const Frame& frame, const ObjectModel& model, int index, int level_count,
                     double median_mm, FrameFindings& findings) {
  const ModelInfo& info = model.info();
  const CameraIntrinsics& camera = frame.camera;
  const auto size_at = [&](double distance_mm) {
    return std::sqrt(camera.fx * camera.fy) * info.diameter_mm / distance_mm;
  };
  const auto add = [&](FindingCode code, bool refuses, double limit_px, double distance_mm) {
    findings.add({code, refuses, index, {size_at(distance_mm), limit_px, distance_mm}});
  };
  const double reference_mm = info.reference_distance_mm;
  if (!make_scale_plan(model, camera, level_count).ok()) {
    const double scale = template_scale(model, camera, reference_mm);
    const double template_px = size_at(reference_mm) / scale;
    const int coarsest = level_count - 1 - (model.depth_count() - 1 - info.scan_depth);
    if (scale < 1) {
      const double limit_px = template_px * kTemplateScaleMin * std::exp2(-info.base_level);
      return add(FindingCode::kPartTooSmall, true, limit_px, reference_mm);
    }
    const double limit_px = template_px * kTemplateScaleMax * std::exp2(coarsest - info.base_level);
    return add(FindingCode::kPartTooLarge, true, limit_px, reference_mm);
  }
  const double distance_mm = median_mm > 0
                                 ? std::clamp(median_mm, info.distance_min_mm, info.distance_max_mm)
                                 : reference_mm;
  const double largest_px = std::max(camera.width, camera.height);
  if (size_at(distance_mm) < kPartSideMin_px)
    add(FindingCode::kPartTooSmall, false, kPartSideMin_px, distance_mm);
  if (size_at(distance_mm) > largest_px)
    add(FindingCode::kPartTooLarge, false, largest_px, distance_mm);
}

}  // namespace

FrameFindings check_frame(const Frame& given, const FrameCheckRequest& request) noexcept {
  FrameFindings findings;
  const Result<Frame> seen = seen_with(given, request.modality);
  if (!seen.ok()) return findings;
  const Frame& frame = seen.value();
  const bool has_depth = !frame.depth_mm.empty(), has_intensity = !frame.intensity.empty();
  const int width = has_depth ? frame.depth_mm.width : frame.intensity.width;
  const int height = has_depth ? frame.depth_mm.height : frame.intensity.height;
  if (has_depth && has_intensity &&
      (frame.intensity.width != width || frame.intensity.height != height))
    return findings;
  const PixelRange region = pixels_of(frame.roi, width, height);
  check_region(frame, width, height, region, findings);
  const bool known_camera = check_camera(frame.camera, width, height, findings);
  if (region.empty()) return findings;
  DepthSamples samples;
  if (has_depth) check_depth(frame, region, request, samples, findings);
  if (has_intensity) check_intensity(frame, region, findings);
  if (has_depth && has_intensity && samples.measured > 0)
    check_registration(frame, region, findings);
  if (!known_camera || request.models.empty()) return findings;
  const int level_count = pyramid_level_count(request.models);
  const double median_mm = samples.measured > 0 ? samples.quantile(0.5) : 0;
  for_each_wanted(request, [&](const ObjectModel& model, int index) {
    check_part_size(frame, model, index, level_count, median_mm, findings);
  });
  return findings;
}

}  // namespace binpick
