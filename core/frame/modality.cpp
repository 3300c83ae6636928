#include "binpick/frame/modality.hpp"

namespace binpick {

Result<Frame> seen_with(const Frame& frame, Modality modality) {
  const bool has_depth = !frame.depth_mm.empty(), has_intensity = !frame.intensity.empty();
  if (!has_depth && !has_intensity) return Error{ErrorCode::kFrameEmpty, 0, "frame"};
  const bool wants_depth = modality == Modality::kDepthAndIntensity || modality == Modality::kDepth;
  const bool wants_intensity =
      modality == Modality::kDepthAndIntensity || modality == Modality::kIntensity;
  if (wants_depth && !has_depth) return Error{ErrorCode::kFrameWithoutDepth, 0, "modality"};
  if (wants_intensity && !has_intensity)
    return Error{ErrorCode::kFrameWithoutIntensity, 0, "modality"};
  Frame seen = frame;
  if (modality == Modality::kIntensity) seen.depth_mm = {};
  if (modality == Modality::kDepth) seen.intensity = {};
  return seen;
}

}  // namespace binpick
