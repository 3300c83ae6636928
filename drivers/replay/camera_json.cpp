#include "replay/camera_json.hpp"

#include <algorithm>
#include <cmath>

#include "replay/camera_keys.hpp"
#include "replay/lens_json.hpp"

namespace binpick::drivers {
namespace {

constexpr int kNestedMax = 6;
constexpr const char* kExpected =
    "expected are fx, fy, cx, cy (RealSense: ppx, ppy); or K, cam_K or camera_matrix with nine "
    "numbers (BOP, ROS, OpenCV); or Open3D's intrinsic_matrix";

std::optional<JsonNode> member(const JsonNode& object, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    for (const auto& [name, node] : object.members())
      if (plain_key(name) == key) return node;
  }
  return std::nullopt;
}

bool is_matrix(const JsonNode& node) {
  return !node.is_object() || member(node, {"data"}).has_value();
}

std::optional<JsonNode> matrix_of(const JsonNode& object) {
  const auto node =
      member(object, {"camk", "k", "cameramatrix", "mtx", "intrinsicmatrix", "intrinsics"});
  return node && is_matrix(*node) ? node : std::nullopt;
}

bool is_camera(const JsonNode& node) {
  return node.is_object() && (matrix_of(node) || member(node, {"fx", "fy", "ppx", "ppy"}));
}

void collect_cameras(const CameraNode& at, int nested_left, std::vector<CameraNode>& found) {
  for (const auto& [key, node] : at.path.front().members()) {
    if (!node.is_object()) continue;
    CameraNode child{at.name.empty() ? key : at.name + "." + key, {node}};
    child.path.insert(child.path.end(), at.path.begin(), at.path.end());
    if (is_camera(node))
      found.push_back(std::move(child));
    else if (nested_left > 0)
      collect_cameras(child, nested_left - 1, found);
  }
}

// A number that has to be there; a key that was mistyped is shown.
double own_number(const CameraNode& camera, std::initializer_list<const char*> keys) {
  if (const auto node = own_value(camera, keys)) return node->number();
  std::string meant;
  for (const auto& [name, node] : camera.path.front().members()) {
    const std::string plain = plain_key(name);
    if (!is_known_camera_key(plain) && nearest_camera_key(plain) == *keys.begin())
      meant = "; was \"" + name + "\" meant?";
  }
  camera.path.front().fail("has no key \"" + std::string(*keys.begin()) + "\"" +
                           (meant.empty() ? std::string(": ") + kExpected : meant));
}

// [fx, 0, cx, 0, fy, cy, 0, 0, 1]; Open3D writes the columns one after the other.
CameraIntrinsics intrinsics_of_matrix(const JsonNode& node, bool columns_allowed) {
  const std::vector<double> m = flat_numbers(node);
  if (m.size() != 9) node.fail("has " + std::to_string(m.size()) + " numbers where 9 are expected");
  const auto zero = [&](std::initializer_list<int> places) {
    return std::all_of(places.begin(), places.end(),
                       [&](int i) { return m[static_cast<std::size_t>(i)] == 0; });
  };
  const bool by_rows = zero({3, 6, 7}), by_columns = zero({1, 2, 5}) && !by_rows;
  if (by_columns && !columns_allowed) {
    node.fail(
        "is transposed: row by row it has to be [fx, 0, cx, 0, fy, cy, 0, 0, 1]; only Open3D's "
        "intrinsic_matrix is read column by column");
  }
  const double skew = by_columns ? m[3] : m[1];
  if ((!by_rows && !by_columns) || std::abs(m[8] - 1) > 1e-9 || std::abs(skew) > 1e-6) {
    node.fail("is not a pinhole camera without skew: [fx, 0, cx, 0, fy, cy, 0, 0, 1] is expected");
  }
  CameraIntrinsics c;
  c.fx = m[0];
  c.fy = m[4];
  c.cx = by_columns ? m[6] : m[2];
  c.cy = by_columns ? m[7] : m[5];
  if (!c.valid()) node.fail("the focal lengths are not positive");
  return c;
}

void take_size(const CameraNode& camera, CameraIntrinsics& c) {
  const auto width = value(camera, {"width", "imagewidth"});
  const auto height = value(camera, {"height", "imageheight"});
  if (width) c.width = width->integer();
  if (height) c.height = height->integer();
  if (const auto size = value(camera, {"imagesize", "resolution"}); size && size->is_list()) {
    const std::vector<double> v = size->numbers(2);
    c.width = static_cast<int>(v[0]);
    c.height = static_cast<int>(v[1]);
  }
  if (c.width < 0 || c.height < 0) camera.path.front().fail("width and height are negative");
}

CameraIntrinsics intrinsics_from_json(const CameraNode& camera) {
  const JsonNode& own = camera.path.front();
  const auto matrix = matrix_of(own);
  const bool has_numbers = own_value(camera, {"fx", "fy"}).has_value();
  CameraIntrinsics c;
  if (matrix) {
    const auto open3d = own_value(camera, {"intrinsicmatrix"});
    c = intrinsics_of_matrix(*matrix, open3d.has_value());
  }
  if (!matrix || has_numbers) {
    const CameraIntrinsics by_matrix = c;
    c.fx = own_number(camera, {"fx"});
    c.fy = own_number(camera, {"fy"});
    c.cx = own_number(camera, {"cx", "ppx"});
    c.cy = own_number(camera, {"cy", "ppy"});
    if (!c.valid()) own.fail("fx and fy are not positive");
    const Eigen::Vector4d difference(c.fx - by_matrix.fx, c.fy - by_matrix.fy, c.cx - by_matrix.cx,
                                     c.cy - by_matrix.cy);
    if (matrix && difference.cwiseAbs().maxCoeff() > 1e-3)
      own.fail("fx, fy, cx, cy and the matrix are not the same camera: leave one of them out");
  }
  if (const auto skew = own_value(camera, {"skew"}); skew && std::abs(skew->number()) > 1e-6)
    skew->fail("is not 0: cameras with skew are not supported");
  take_size(camera, c);
  return c;
}

std::int64_t time_from_json(const JsonNode& node) {
  const double ns = node.number();
  // As exact as a double is: microseconds after a hundred days.
  if (ns < 0 || ns > 9e18) node.fail("is not a time in ns");
  return static_cast<std::int64_t>(ns);
}

// [x, y, width, height], ours; or that of a ROS message, whose K is of the whole image.
Roi roi_from_json(const JsonNode& node) {
  if (node.is_object()) {
    for (const char* key : {"x_offset", "y_offset"}) {
      if (const auto offset = node.find(key); offset && offset->number() != 0)
        offset->fail("is not 0: give the intrinsics of the image as it is, without ROS' roi");
    }
    return {};
  }
  const std::vector<JsonNode> v = node.elements();
  if (v.size() != 4) node.fail("is not a list of four numbers: x, y, width, height");
  const Roi roi{v[0].integer(), v[1].integer(), v[2].integer(), v[3].integer()};
  if (roi.whole_image()) node.fail("its width and height are not positive");
  return roi;
}

// mm per unit; but Open3D's camera files count units per metre.
double depth_scale_from_json(const JsonNode& node, bool open3d) {
  constexpr double kUnitsPerMetreMin = 100;  // mm per unit would be coarser than 0.1 m
  const double scale = node.number();
  if (scale <= 0) node.fail("is not positive");
  return open3d && scale >= kUnitsPerMetreMin ? 1000 / scale : scale;
}

}  // namespace

std::vector<CameraNode> find_cameras(const JsonNode& root) {
  const CameraNode whole{"", {root}};
  if (is_camera(root)) return {whole};
  std::vector<CameraNode> found;
  collect_cameras(whole, kNestedMax, found);
  if (found.empty()) root.fail(std::string("holds no camera: ") + kExpected);
  return found;
}

std::optional<JsonNode> own_value(const CameraNode& camera,
                                  std::initializer_list<const char*> keys) {
  return member(camera.path.front(), keys);
}

std::optional<JsonNode> value(const CameraNode& camera, std::initializer_list<const char*> keys) {
  for (const JsonNode& object : camera.path)
    if (auto node = member(object, keys)) return node;
  return std::nullopt;
}

std::vector<double> flat_numbers(const JsonNode& node) {
  if (node.is_object()) {
    const auto data = member(node, {"data"});
    if (!data) node.fail("holds no numbers");
    return flat_numbers(*data);
  }
  std::vector<double> flat;
  for (const JsonNode& element : node.elements()) {
    if (element.is_list()) {
      const std::vector<double> row = element.numbers(element.elements().size());
      flat.insert(flat.end(), row.begin(), row.end());
    } else {
      flat.push_back(element.number());
    }
  }
  return flat;
}

FrameCamera camera_from_json(const CameraNode& node) {
  FrameCamera camera;
  camera.intrinsics = intrinsics_from_json(node);
  camera.lens = lens_from_json(node);
  const bool open3d = own_value(node, {"intrinsicmatrix"}).has_value();
  if (const auto scale = value(node, {"depthscale"}))
    camera.depth_scale = depth_scale_from_json(*scale, open3d);
  if (const auto roi = value(node, {"roi"})) camera.roi = roi_from_json(*roi);
  for (const char* key : {"binningx", "binningy"}) {
    if (const auto binning = value(node, {key}); binning && binning->number() > 1)
      binning->fail("is more than 1: give the intrinsics of the image as it is, after binning");
  }
  if (const auto time = value(node, {"capturens"})) camera.capture_ns = time_from_json(*time);
  if (const auto time = value(node, {"devicens"})) camera.device_ns = time_from_json(*time);
  return camera;
}

}  // namespace binpick::drivers
