// Looks at a frame, and at the models it is to be searched for, before the search: the mistakes of
// the first day (units, invalid values, another camera's intrinsics) otherwise end in "nothing
// found". Reads some thousand pixels; allocates nothing. The findings are values: their sentences
// are made in app. Pure; any thread.
#pragma once

#include <array>
#include <span>

#include "binpick/frame/frame.hpp"
#include "binpick/frame/modality.hpp"
#include "binpick/model/object_model.hpp"

namespace binpick {

// The comment names the numbers of a finding in their order. Sizes of images in px, depths in mm.
enum class FindingCode : int {
  kRoiOutside = 0,          // x, y, width, height of the region; width, height of the image
  kRoiBarelyInside,         // share of the region that lies in the image
  kPrincipalPointOff,       // cx, cy; width, height of the image
  kFocalLengthImplausible,  // fx, fy, angle of view in degrees
  kNothingMeasured,         // -
  kLittleMeasured,          // share of the region with a depth
  kDepthAllOneValue,        // value
  kDepthRepeatedValue,      // value, share of the measured pixels that have it, its code in the
                            // depth image (0: not known)
  kDepthUnit,               // median, factor that would bring it to the trained distances, their
                            // minimum and maximum (0 without a model), depth scale (0: none)
  kDepthNotTrained,         // 5 % and 95 % of the measured depths, trained minimum and maximum
  kPartTooSmall,            // its largest extent in the image, the least allowed, distance
  kPartTooLarge,            // its largest extent in the image, the most allowed, distance
  kIntensityBlack,          // brightest value
  kIntensitySaturated,      // share of pixels
  kIntensityFlat,           // value
  kIntensityNotRegistered,  // what it is off by along x and y; both 0: not known
};
inline constexpr int kFindingCodeCount = 16;
inline constexpr int kFindingNumbers = 6;

struct Finding {
  FindingCode code = FindingCode::kRoiOutside;
  bool refuses = false;  // it can only be a mistake; otherwise it is merely unlikely
  int model = -1;        // index into the models, where it is about one
  std::array<double, kFindingNumbers> numbers{};
};

struct FrameFindings {
  static constexpr int kMax = 16;
  std::array<Finding, kMax> list{};
  int count = 0;

  std::span<const Finding> found() const { return {list.data(), static_cast<std::size_t>(count)}; }
  void add(const Finding& finding) {
    if (count < kMax) list[static_cast<std::size_t>(count++)] = finding;
  }
  // The first that refuses the frame; nullptr: it can be searched.
  const Finding* refusal() const {
    for (const Finding& finding : found()) {
      if (finding.refuses) return &finding;
    }
    return nullptr;
  }
};

struct FrameCheckRequest {
  std::span<const ObjectModel> models;  // of the detector; empty: the frame alone
  std::span<const int> wanted;          // which of them are looked for; empty: all
  Modality modality = Modality::kAutomatic;
};

// What makes detect() return an error (images that are missing or differ in size) is left to it.
FrameFindings check_frame(const Frame& frame, const FrameCheckRequest& request) noexcept;

}  // namespace binpick
