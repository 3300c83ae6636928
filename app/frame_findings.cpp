#include "frame_findings.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "modbus/register_map.hpp"

namespace binpick::app {
namespace {

using nlohmann::ordered_json;
using Reason = modbus::map::NoPickReasonsBit;

struct Description {
  const char* name;
  Reason reason;
  std::array<const char*, kFindingNumbers> numbers;  // nullptr: not used
};

// In the order of FindingCode.
constexpr Description kDescriptions[] = {
    {"roi_outside",
     Reason::kCameraUnlikely,
     {"x", "y", "width", "height", "image_width", "image_height"}},
    {"roi_barely_inside", Reason::kCameraUnlikely, {"share_inside"}},
    {"principal_point_off", Reason::kCameraUnlikely, {"cx", "cy", "image_width", "image_height"}},
    {"focal_length_implausible", Reason::kCameraUnlikely, {"fx", "fy", "angle_of_view_deg"}},
    {"nothing_measured", Reason::kNoMeasurement, {}},
    {"little_measured", Reason::kNoMeasurement, {"share"}},
    {"depth_all_one_value", Reason::kDepthRepeated, {"depth_mm"}},
    {"depth_repeated_value", Reason::kDepthRepeated, {"depth_mm", "share", "image_value"}},
    {"depth_unit",
     Reason::kDepthNotTrained,
     {"median_mm", "factor", "trained_min_mm", "trained_max_mm", "depth_scale"}},
    {"depth_not_trained",
     Reason::kDepthNotTrained,
     {"measured_min_mm", "measured_max_mm", "trained_min_mm", "trained_max_mm"}},
    {"part_too_small", Reason::kPartSize, {"size_px", "least_px", "distance_mm"}},
    {"part_too_large", Reason::kPartSize, {"size_px", "most_px", "distance_mm"}},
    {"intensity_black", Reason::kIntensityUnusable, {"brightest"}},
    {"intensity_saturated", Reason::kIntensityUnusable, {"share"}},
    {"intensity_flat", Reason::kIntensityUnusable, {"value"}},
    {"intensity_not_registered", Reason::kIntensityUnusable, {"shift_x_px", "shift_y_px"}},
};
static_assert(std::size(kDescriptions) == kFindingCodeCount);

const Description& description_of(FindingCode code) {
  return kDescriptions[static_cast<std::size_t>(code)];
}

void write_camera_finding(const Finding& f, FixedText& text) {
  const auto& n = f.numbers;
  switch (f.code) {
    case FindingCode::kRoiOutside:
      return text.print(
          "the region of interest (x %.0f, y %.0f, %.0fx%.0f) lies outside the image of %.0fx%.0f "
          "pixels",
          n[0], n[1], n[2], n[3], n[4], n[5]);
    case FindingCode::kRoiBarelyInside:
      return text.print("only %.3g %% of the region of interest lies in the image", 100 * n[0]);
    case FindingCode::kPrincipalPointOff: {
      const bool inside = n[0] >= 0 && n[1] >= 0 && n[0] < n[2] && n[1] < n[3];
      return text.print("the principal point (%.6g, %.6g) lies %s the image of %.0fx%.0f pixels",
                        n[0], n[1], inside ? "at the rim of" : "outside", n[2], n[3]);
    }
    default:
      if (n[2] == 0) return text.print("the focal lengths are not positive and finite");
      return text.print(
          "the focal lengths fx = %.6g and fy = %.6g px are implausible for the image: its angle "
          "of view would be %.3g degrees",
          n[0], n[1], n[2]);
  }
}

void write_unit_finding(const Finding& f, const char* part, FixedText& text) {
  const auto& n = f.numbers;
  text.print("the measured depths (median %.4g mm) are ", n[0]);
  if (n[1] > 1) text.print("%.0f times too small", n[1]);
  if (n[1] > 0 && n[1] < 1) text.print("%.0f times too large", 1 / n[1]);
  if (n[1] == 0) text.print("no distances that a 3D sensor measures");
  if (f.model >= 0) text.print(" for %s, which was trained for %.0f to %.0f mm", part, n[2], n[3]);
}

void write_depth_finding(const Finding& f, const char* part, FixedText& text) {
  const auto& n = f.numbers;
  switch (f.code) {
    case FindingCode::kNothingMeasured:
      return text.print("no pixel of the region of interest has a depth");
    case FindingCode::kLittleMeasured:
      return text.print("only %.3g %% of the region of interest has a depth", 100 * n[0]);
    case FindingCode::kDepthAllOneValue:
      return text.print("every measured pixel has the same depth, %.5g mm", n[0]);
    case FindingCode::kDepthRepeatedValue:
      text.print("%.3g %% of the measured pixels have the one depth %.5g mm", 100 * n[1], n[0]);
      if (n[2] > 0) text.print(" (value %.0f in the image)", n[2]);
      return text.print(", and hardly any has one near it: it seems to stand for \"not measured\"");
    case FindingCode::kDepthUnit:
      return write_unit_finding(f, part, text);
    default:
      return text.print(
          "the measured depths (%.0f to %.0f mm) are not those that %s was trained for (%.0f to "
          "%.0f mm)",
          n[0], n[1], part, n[2], n[3]);
  }
}

void write_intensity_finding(const Finding& f, FixedText& text) {
  const auto& n = f.numbers;
  switch (f.code) {
    case FindingCode::kIntensityBlack:
      return text.print("the intensity image is black: its brightest value is %.0f of 255", n[0]);
    case FindingCode::kIntensitySaturated:
      return text.print("%.3g %% of the intensity image is saturated", 100 * n[0]);
    case FindingCode::kIntensityFlat:
      return text.print("the intensity image has no contrast: it is %.0f everywhere", n[0]);
    default:
      text.print("the edges of the intensity image do not lie on the steps of the depth image");
      if (n[0] != 0) text.print(", but about %.0f px beside them along x", n[0]);
      if (n[1] != 0)
        text.print("%s about %.0f px beside them along y", n[0] != 0 ? " and" : ", but", n[1]);
  }
}

void write_unit_advice(const Finding& f, FixedText& text) {
  const double factor = f.numbers[1], scale = f.numbers[4];
  if (factor > 0 && scale > 0) {
    return text.print("set depth_scale to %.4g mm per unit of the depth image; it is %.4g",
                      scale * factor, scale);
  }
  text.print("give depths in mm");
  if (factor == 1000) text.print("; these look like metres");
  if (factor == 0.001) text.print("; these look like micrometres");
}

}  // namespace

const char* finding_name(FindingCode code) {
  return description_of(code).name;
}

std::uint16_t no_pick_reason_of(FindingCode code) {
  return static_cast<std::uint16_t>(description_of(code).reason);
}

void write_finding(const Finding& finding, const char* part, FixedText& text) {
  switch (description_of(finding.code).reason) {
    case Reason::kCameraUnlikely:
      return write_camera_finding(finding, text);
    case Reason::kPartSize: {
      const bool small = finding.code == FindingCode::kPartTooSmall;
      return text.print("%s would be %.3g px large in this image at %.0f mm, %s than %.3g px", part,
                        finding.numbers[0], finding.numbers[2], small ? "less" : "more",
                        finding.numbers[1]);
    }
    case Reason::kIntensityUnusable:
      return write_intensity_finding(finding, text);
    default:
      return write_depth_finding(finding, part, text);
  }
}

void write_advice(const Finding& finding, FixedText& text) {
  switch (finding.code) {
    case FindingCode::kRoiOutside:
    case FindingCode::kRoiBarelyInside:
      return text.print("correct the region (--roi, roi of the data set, roi_px of the recipe)");
    case FindingCode::kPrincipalPointOff:
      return text.print("check that the camera data are those of this image size");
    case FindingCode::kFocalLengthImplausible:
      return text.print("give fx and fy in pixels of this image, not in mm");
    case FindingCode::kNothingMeasured:
    case FindingCode::kLittleMeasured:
      return text.print("check the depth image, and the sensor's exposure and working distance");
    case FindingCode::kDepthAllOneValue:
      return text.print("check that this is a depth image, and that the sensor measures");
    case FindingCode::kDepthRepeatedValue:
      return text.print("have pixels that were not measured written as 0");
    case FindingCode::kDepthUnit:
      return write_unit_advice(finding, text);
    case FindingCode::kDepthNotTrained:
      return text.print("train for these distances, or move the sensor, unless the bin is empty");
    case FindingCode::kPartTooSmall:
    case FindingCode::kPartTooLarge:
      return text.print("check fx and fy, or train with the camera file of this camera");
    case FindingCode::kIntensityBlack:
      return text.print("lengthen the exposure, and check the image's bit depth");
    case FindingCode::kIntensitySaturated:
      return text.print("shorten the exposure");
    case FindingCode::kIntensityFlat:
      return text.print("check that this is the intensity image of the scene");
    case FindingCode::kIntensityNotRegistered:
      return text.print("give the two images of one frame, the depth registered to the intensity");
  }
}

std::string finding_text(const Finding& finding, const PartName& name) {
  std::array<char, 512> memory;
  FixedText text(memory);
  const std::string part = finding.model >= 0 ? name(finding.model) : "";
  write_finding(finding, part.c_str(), text);
  text.add("; ");
  write_advice(finding, text);
  return std::string(text.text());
}

std::vector<std::string> FindingsTold::fresh(const FrameFindings& findings, const PartName& name) {
  std::vector<std::string> sentences;
  for (const Finding& finding : findings.found()) {
    if (told_.emplace(finding.code, finding.model).second)
      sentences.push_back(finding_text(finding, name));
  }
  return sentences;
}

ordered_json to_json(const FrameFindings& findings, const PartName& name) {
  ordered_json list = ordered_json::array();
  for (const Finding& finding : findings.found()) {
    std::array<char, 512> memory;
    FixedText text(memory);
    const Description& description = description_of(finding.code);
    ordered_json entry = {{"code", description.name},
                          {"severity", finding.refuses ? "refused" : "warning"}};
    const std::string part = finding.model >= 0 ? name(finding.model) : "";
    if (finding.model >= 0) entry["part"] = part;
    for (std::size_t i = 0; i < finding.numbers.size() && description.numbers[i] != nullptr; ++i)
      entry["numbers"][description.numbers[i]] = finding.numbers[i];
    write_finding(finding, part.c_str(), text);
    entry["text"] = std::string(text.text());
    text.clear();
    write_advice(finding, text);
    entry["advice"] = std::string(text.text());
    list.push_back(entry);
  }
  return list;
}

}  // namespace binpick::app
