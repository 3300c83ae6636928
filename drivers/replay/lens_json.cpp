#include "replay/lens_json.hpp"

#include <algorithm>

#include "replay/camera_keys.hpp"

namespace binpick::drivers {
namespace {

struct LensModel {
  const char* name;  // plain
  enum { kOpenCv, kOnlyZero, kNever } use;
  const char* what = "";
};

// A model that is no polynomial of the pinhole image is wrong even where its numbers are zero.
constexpr LensModel kModels[] = {
    {"", LensModel::kOpenCv},
    {"none", LensModel::kOnlyZero, "none"},
    {"plumbbob", LensModel::kOpenCv},
    {"rationalpolynomial", LensModel::kOpenCv},
    {"radtan", LensModel::kOpenCv},
    {"brownconrady", LensModel::kOpenCv},
    {"opencv", LensModel::kOpenCv},
    {"pinhole", LensModel::kOpenCv},
    {"inversebrownconrady", LensModel::kOnlyZero, "inverse Brown-Conrady"},
    {"modifiedbrownconrady", LensModel::kOnlyZero, "modified Brown-Conrady"},
    {"thinprism", LensModel::kOnlyZero, "thin prism"},
    {"equidistant", LensModel::kNever, "equidistant (fisheye)"},
    {"fisheye", LensModel::kNever, "fisheye"},
    {"opencvfisheye", LensModel::kNever, "fisheye"},
    {"kannalabrandt4", LensModel::kNever, "Kannala-Brandt (fisheye)"},
    {"kannalabrandt", LensModel::kNever, "Kannala-Brandt (fisheye)"},
    {"ftheta", LensModel::kNever, "f-theta (fisheye)"},
    {"omnidirectional", LensModel::kNever, "omnidirectional"},
};
// As librealsense numbers them.
constexpr const char* kRealSenseModels[] = {"none",   "modifiedbrownconrady", "inversebrownconrady",
                                            "ftheta", "brownconrady",         "kannalabrandt4"};

constexpr const char* kRectify =
    ": only OpenCV's 4, 5 or 8 coefficients (ROS plumb_bob, rational_polynomial) are removed from "
    "images; rectify the images with the maker's software, and give a camera file of the rectified "
    "images, without distortion";

std::string model_name(const JsonNode& node) {
  if (node.is_number()) {
    const int number = node.integer();
    if (number < 0 || number >= static_cast<int>(std::size(kRealSenseModels)))
      node.fail("is not the number of a RealSense distortion model, 0 to 5");
    return kRealSenseModels[number];
  }
  std::string name = plain_key(node.text());
  for (const char* prefix : {"distortion.", "rs2distortion"})
    if (name.starts_with(prefix)) name.erase(0, std::string(prefix).size());
  return name;
}

// k1, k2, ... as keys of their own.
std::vector<double> named_coefficients(const CameraNode& holder) {
  std::vector<double> c;
  for (const char* key : {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}) {
    const auto node = own_value(holder, {key});
    c.push_back(node && node->is_number() ? node->number() : 0);
  }
  return c;
}

LensDistortion lens_of(const std::vector<double>& c, const JsonNode& node) {
  const std::size_t count = c.size();
  if (count != 0 && count != 4 && count != 5 && count != 8 && count != 12 && count != 14) {
    node.fail("has " + std::to_string(count) +
              " coefficients: expected are OpenCV's 4 (k1, k2, p1, p2), 5 (and k3) or 8 (and k4, "
              "k5, k6)");
  }
  if (count > 8 && std::any_of(c.begin() + 8, c.end(), [](double v) { return v != 0; }))
    node.fail("has coefficients of a thin prism or a tilted sensor" + std::string(kRectify));
  const auto at = [&](std::size_t i) { return i < count ? c[i] : 0; };
  return {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)};
}

}  // namespace

LensDistortion lens_from_json(const CameraNode& camera) {
  auto model = value(camera, {"distortionmodel"});
  if (!model) model = own_value(camera, {"model"});
  auto node = value(camera, {"distortioncoefficients", "distortioncoeffs", "distcoeffs",
                             "distcoeff", "distortion", "dist", "coeffs", "d"});
  LensDistortion lens;
  const bool is_object = node && node->is_object();
  const CameraNode inner = is_object ? CameraNode{camera.name, {*node}} : camera;
  if (is_object && !node->find("data")) {
    if (const auto own = own_value(inner, {"distortionmodel", "model", "type"})) model = own;
    node = own_value(inner, {"coeffs", "coefficients", "distcoeffs", "data", "d"});
  }
  if (node && !node->is_null())
    lens = lens_of(flat_numbers(*node), *node);
  else
    lens = lens_of(named_coefficients(inner), inner.path.front());

  if (!model || model->is_null()) return lens;
  const std::string name = model_name(*model);
  const auto known = std::find_if(std::begin(kModels), std::end(kModels),
                                  [&](const LensModel& m) { return name == m.name; });
  if (known == std::end(kModels)) {
    if (!lens.none()) model->fail("'" + name + "' is not a known distortion model" + kRectify);
  } else if (known->use == LensModel::kNever ||
             (known->use == LensModel::kOnlyZero && !lens.none())) {
    model->fail("the distortion model is " + std::string(known->what) + kRectify);
  }
  return lens;
}

}  // namespace binpick::drivers
