#include "detect/detector_plan.hpp"

#include <algorithm>
#include <cmath>

namespace binpick {
namespace {

int largest_offset(const ObjectModel& model, int d) {
  int largest = 0;
  for (const TemplateRange& t : model.depth(d).templates) {
    for (const Feature& f : model.features(t)) {
      largest =
          std::max({largest, std::abs(static_cast<int>(f.x)), std::abs(static_cast<int>(f.y))});
    }
  }
  return largest;
}

// A frame below this shows nothing that could be recognized.
constexpr int kFrameSidePxMin = 16;

int rounded_up(int value, int multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace

int pyramid_level_count(std::span<const ObjectModel> models) {
  int level_count = kFeatureLevel + 1;
  for (const ObjectModel& model : models) {
    const ModelInfo& info = model.info();
    const int leaf = model.depth_count() - 1;
    // Nearer than the reference distance the part is larger: coarser levels serve.
    const double nearest_mm = model.distance_mm(info.scan_depth, 0);
    const int nearer = std::max(
        0, static_cast<int>(std::lround(std::log2(info.reference_distance_mm / nearest_mm))));
    level_count = std::max(level_count, info.base_level + leaf - info.scan_depth + 2 + nearer);
  }
  return std::min(level_count, kPyramidLevelsMax);
}

DetectorPlan make_detector_plan(std::span<const ObjectModel> models, const DetectorLimits& limits,
                                int thread_count) {
  BINPICK_ASSERT(!models.empty());
  DetectorPlan plan;
  plan.limits = limits;
  plan.results_max = limits.results_max;
  plan.normal_codebook = models.front().info().normal_codebook;
  PyramidPlan& pyramid = plan.pyramid;
  pyramid.level_count = pyramid_level_count(models);
  int offset = 0;
  for (const ObjectModel& model : models) {
    BINPICK_ASSERT(model.info().normal_codebook == plan.normal_codebook);
    const int leaf = model.depth_count() - 1;
    for (int d = model.info().scan_depth; d <= leaf; ++d) {
      offset = std::max(offset, largest_offset(model, d));
      const int nodes =
          static_cast<int>(model.depth(d).templates.size()) * model.depth(d).distance_count;
      if (d < leaf) plan.search.nodes_max = std::max(plan.search.nodes_max, nodes);
    }
    const TreeDepth& scanned = model.depth(model.info().scan_depth);
    int features = 0;
    for (const TemplateRange& t : scanned.templates) features += t.count;
    plan.search.scan.templates_max =
        std::max(plan.search.scan.templates_max, static_cast<int>(scanned.templates.size()));
    plan.search.scan.features_max = std::max(plan.search.scan.features_max, features);
  }
  pyramid.border = rounded_up(static_cast<int>(offset * kTemplateScaleMax) + 8, 4);
  const int align = 1 << (pyramid.level_count - 1);
  const int width =
      limits.roi_width > 0
          ? std::min(limits.image_width, limits.roi_width + 2 * (kRegionMarginPx + align))
          : limits.image_width;
  const int height =
      limits.roi_height > 0
          ? std::min(limits.image_height, limits.roi_height + 2 * (kRegionMarginPx + align))
          : limits.image_height;
  pyramid.width_max = rounded_up(width, align);
  pyramid.height_max = rounded_up(height, align);
  // The coarsest level is only ever scanned.
  for (int l = 0; l + 1 < pyramid.level_count; ++l) pyramid.rearranged_from_level[l] = true;
  plan.search.scan.width_max = pyramid.width_max;
  plan.search.scan.height_max = pyramid.height_max;
  // Scanned levels are at least leaf - scan_depth levels below full resolution.
  int finest_scan = kPyramidLevelsMax;
  for (const ObjectModel& model : models)
    finest_scan = std::min(finest_scan, model.depth_count() - 1 - model.info().scan_depth);
  plan.search.scan.width_max >>= finest_scan;
  plan.search.scan.height_max >>= finest_scan;
  plan.search.scan.thread_count = thread_count;
  plan.search.region_width_max = pyramid.width_max;
  plan.search.region_height_max = pyramid.height_max;
  return plan;
}

Result<Roi> region_of(const Frame& frame, const DetectorPlan& plan) {
  const bool has_depth = !frame.depth_mm.empty(), has_intensity = !frame.intensity.empty();
  if (!has_depth && !has_intensity) return Error{ErrorCode::kFrameEmpty, 0, "frame"};
  const int width = has_depth ? frame.depth_mm.width : frame.intensity.width;
  const int height = has_depth ? frame.depth_mm.height : frame.intensity.height;
  if (has_depth && has_intensity &&
      (frame.intensity.width != width || frame.intensity.height != height)) {
    return Error{ErrorCode::kFrameSizeMismatch, frame.intensity.width, "intensity width"};
  }
  if (width < kFrameSidePxMin || height < kFrameSidePxMin) {
    return Error{ErrorCode::kFrameEmpty, width, "smaller than any part"};
  }
  if (width > plan.limits.image_width || height > plan.limits.image_height)
    return Error{ErrorCode::kFrameTooLarge, width, "frame width"};
  if (!frame.camera.valid()) return Error{ErrorCode::kIntrinsicsInvalid, 0, "camera"};
  Roi roi = frame.roi;
  if (roi.whole_image()) roi = {0, 0, width, height};
  const long long right = std::min<long long>(width, static_cast<long long>(roi.x) + roi.width);
  const long long bottom = std::min<long long>(height, static_cast<long long>(roi.y) + roi.height);
  const int left = std::max(0, roi.x), top = std::max(0, roi.y);
  if (left >= right || top >= bottom) return Error{ErrorCode::kRoiOutsideImage, roi.x, "roi"};
  const int align = 1 << (plan.pyramid.level_count - 1);
  Roi region;
  region.x = std::max(0, left - kRegionMarginPx) / align * align;
  region.y = std::max(0, top - kRegionMarginPx) / align * align;
  // Rounded up: what lies beyond the image is no measurement.
  region.width =
      rounded_up(std::min(width, static_cast<int>(right) + kRegionMarginPx) - region.x, align);
  region.height =
      rounded_up(std::min(height, static_cast<int>(bottom) + kRegionMarginPx) - region.y, align);
  if (region.width > plan.pyramid.width_max || region.height > plan.pyramid.height_max)
    return Error{ErrorCode::kRoiTooLarge, region.width, "roi"};
  return region;
}

bool centre_inside_roi(const Frame& frame, const Roi& region, const Pose& T, const Scene& scene) {
  const Vec2 uv = scene.intensity.camera.project(T.t_mm) + Vec2(region.x, region.y);
  const bool has_depth = !frame.depth_mm.empty();
  const PixelRange inside =
      pixels_of(frame.roi, has_depth ? frame.depth_mm.width : frame.intensity.width,
                has_depth ? frame.depth_mm.height : frame.intensity.height);
  return uv.x() >= inside.x0 && uv.y() >= inside.y0 && uv.x() < inside.x1 && uv.y() < inside.y1;
}

}  // namespace binpick
