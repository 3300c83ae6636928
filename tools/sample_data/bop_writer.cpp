#include "bop_writer.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "mesh_files.hpp"

namespace binpick::simulation {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kDepthScaleMm = 0.1;

std::string numbered(const char* format, int number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, number);
  return text.data();
}

// Rounding to a decimal step leaves digits like 0.30000000000000004; going through text does not.
Json number(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return Json::parse(text.data());
}

Json row_major(const Mat3& R) {
  Json out = Json::array();
  for (int i = 0; i < 9; ++i) out.push_back(number(R(i / 3, i % 3), 9));
  return out;
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  if (!out) throw std::runtime_error("cannot write " + path.string());
}

void write_png(const fs::path& path, const cv::Mat& image) {
  if (!cv::imwrite(path.string(), image, {cv::IMWRITE_PNG_COMPRESSION, 9})) {
    throw std::runtime_error("cannot write " + path.string());
  }
}

std::string as_object(const std::vector<std::string>& lines) {
  std::string text = "{\n";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += " \"" + std::to_string(i) + "\": " + lines[i] + (i + 1 < lines.size() ? ",\n" : "\n");
  }
  return text + "}\n";
}

Json box(const PixelBox& b) {
  return Json::array({b.x, b.y, b.width, b.height});
}

Json model_info(const Part& part) {
  const Bounds extent = bounds(part.mesh);
  Json info;
  info["diameter"] = number(diameter(part.mesh), 5);
  const std::array axes = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    info[std::string("min_") + axes[static_cast<std::size_t>(k)]] = number(extent.min[k], 5);
  }
  for (int k = 0; k < 3; ++k) {
    info[std::string("size_") + axes[static_cast<std::size_t>(k)]] =
        number(extent.max[k] - extent.min[k], 5);
  }
  for (const auto& pose : part.symmetries) {
    Json matrix = Json::array();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) matrix.push_back(number(pose.R(r, c), 9));
      matrix.push_back(number(pose.t_mm[r], 5));
    }
    for (double last : {0.0, 0.0, 0.0, 1.0}) matrix.push_back(last);
    info["symmetries_discrete"].push_back(matrix);
  }
  for (const auto& axis : part.symmetry_axes) {
    Json symmetry;
    symmetry["axis"] = {axis.x(), axis.y(), axis.z()};
    symmetry["offset"] = {0.0, 0.0, 0.0};
    info["symmetries_continuous"].push_back(symmetry);
  }
  return info;
}

}  // namespace

void write_models(const fs::path& root, const std::vector<Part>& parts,
                  const CameraParams& camera) {
  fs::create_directories(root / "models");
  Json all;
  for (const auto& part : parts) {
    write_ply(part.mesh, (root / "models" / numbered("obj_%06d.ply", part.obj_id)).string());
    all[std::to_string(part.obj_id)] = model_info(part);
  }
  write_text(root / "models" / "models_info.json", all.dump(1) + "\n");
  Json json;
  json["width"] = camera.width;
  json["height"] = camera.height;
  json["fx"] = camera.fx;
  json["fy"] = camera.fy;
  json["cx"] = camera.cx;
  json["cy"] = camera.cy;
  json["depth_scale"] = kDepthScaleMm;
  write_text(root / "camera.json", json.dump(1) + "\n");
}

SceneWriter::SceneWriter(const fs::path& root, int scene_id)
    : folder_(root / "test" / numbered("%06d", scene_id)) {
  fs::create_directories(folder_ / "gray");
  fs::create_directories(folder_ / "depth");
}

void SceneWriter::add(const Frame& frame) {
  const std::string name = numbered("%06d.png", static_cast<int>(gt_lines_.size()));
  const View& view = frame.view;
  cv::Mat gray(view.height, view.width, CV_8U);
  std::copy(frame.gray.begin(), frame.gray.end(), gray.data);
  write_png(folder_ / "gray" / name, gray);
  cv::Mat depth(view.height, view.width, CV_16U);
  std::copy(frame.depth.begin(), frame.depth.end(), depth.ptr<std::uint16_t>());
  write_png(folder_ / "depth" / name, depth);

  Json camera;
  camera["cam_K"] = {view.fx, 0.0, view.cx, 0.0, view.fy, view.cy, 0.0, 0.0, 1.0};
  camera["depth_scale"] = kDepthScaleMm;
  camera["roi"] = {frame.roi.x, frame.roi.y, frame.roi.width, frame.roi.height};
  camera_lines_.push_back(camera.dump());
  Json gt = Json::array();
  Json info = Json::array();
  for (const auto& instance : frame.instances) {
    Json pose;
    pose["cam_R_m2c"] = row_major(instance.T_cam_obj.R);
    const Vec3& t = instance.T_cam_obj.t_mm;
    pose["cam_t_m2c"] = {number(t.x(), 4), number(t.y(), 4), number(t.z(), 4)};
    pose["obj_id"] = instance.obj_id;
    gt.push_back(pose);
    Json seen;
    seen["px_count_all"] = instance.px_count_all;
    seen["px_count_visib"] = instance.px_count_visib;
    seen["px_count_valid"] = instance.px_count_valid;
    seen["visib_fract"] = number(instance.visib_fract, 4);
    seen["bbox_obj"] = box(instance.bbox_obj);
    seen["bbox_visib"] = box(instance.bbox_visib);
    info.push_back(seen);
  }
  gt_lines_.push_back(gt.dump());
  info_lines_.push_back(info.dump());
}

void SceneWriter::finish() const {
  write_text(folder_ / "scene_camera.json", as_object(camera_lines_));
  write_text(folder_ / "scene_gt.json", as_object(gt_lines_));
  write_text(folder_ / "scene_gt_info.json", as_object(info_lines_));
}

}  // namespace binpick::simulation
