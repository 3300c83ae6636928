#include "scene_source.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

namespace fs = std::filesystem;

namespace binpick::sim {
namespace {

using drivers::BopDataset;
using drivers::DatasetError;

// 1280x1024 takes 4 MB decoded, and a loop over few images should not decode at all.
constexpr std::size_t kKeptMax = 32;

bool is_number(const std::string& name) {
  return !name.empty() &&
         std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool holds_scenes(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_directory(error) && is_number(entry.path().filename().string()) &&
        fs::exists(entry.path() / "scene_camera.json", error)) {
      return true;
    }
  }
  return false;
}

std::unique_ptr<BopDataset> open_dataset(const std::string& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw DatasetError(folder + ": there is no such folder");
  const fs::path path = fs::canonical(folder, error);
  if (holds_scenes(path)) {
    return std::make_unique<BopDataset>(path.parent_path().string(), path.filename().string());
  }
  std::vector<std::string> splits;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, error)) {
    if (entry.is_directory(error) && holds_scenes(entry.path()))
      splits.push_back(entry.path().filename().string());
  }
  if (splits.empty())
    throw DatasetError(folder + ": holds no scene (a numbered folder with scene_camera.json)");
  std::sort(splits.begin(), splits.end());
  const bool has_test = std::find(splits.begin(), splits.end(), "test") != splits.end();
  return std::make_unique<BopDataset>(path.string(), has_test ? "test" : splits.front());
}

// The depth image with its codes as they are in the file.
cv::Mat read_codes(const std::string& scene_path, int image_id) {
  char name[32];
  std::snprintf(name, sizeof name, "%06d", image_id);
  const fs::path stem = fs::path(scene_path) / "depth" / name;
  for (const char* extension : {".png", ".tif", ".tiff"}) {
    const std::string path = stem.string() + extension;
    std::error_code error;
    if (!fs::is_regular_file(path, error)) continue;
    const cv::Mat codes = cv::imread(path, cv::IMREAD_UNCHANGED);
    if (codes.type() != CV_16UC1)
      throw DatasetError(path + ": is not a depth image of one channel of 16 bits");
    return codes;
  }
  throw DatasetError(stem.string() + ".*: there is no such PNG or TIFF file");
}

}  // namespace

SceneSource::SceneSource(const std::string& folder, std::optional<int> scene_id)
    : dataset_(open_dataset(folder)) {
  scene_ = dataset_->scene(scene_id ? *scene_id : dataset_->scene_ids().front());
  for (const auto& [id, camera] : scene_.frames) {
    image_ids_.push_back(id);
    if (camera.depth_scale != scene_.frames.begin()->second.depth_scale) {
      throw DatasetError(scene_.path + ": image " + std::to_string(id) +
                         " has a depth_scale of its own; a sensor has one");
    }
  }
  if (image_ids_.empty()) throw DatasetError(scene_.path + ": scene_camera.json lists no image");
}

std::shared_ptr<const SceneFrame> SceneSource::load(int image_id) const {
  const drivers::LoadedFrame loaded = dataset_->load_frame(scene_, image_id);
  const cv::Mat codes = read_codes(scene_.path, image_id);
  auto frame = std::make_shared<SceneFrame>();
  frame->image_id = image_id;
  frame->width = codes.cols;
  frame->height = codes.rows;
  frame->depth_codes.reserve(codes.total());
  for (int y = 0; y < codes.rows; ++y) {
    const auto* row = codes.ptr<std::uint16_t>(y);
    frame->depth_codes.insert(frame->depth_codes.end(), row, row + codes.cols);
  }
  frame->gray = loaded.intensity;
  frame->depth_scale = *scene_.frames.at(image_id).depth_scale;
  frame->fx = loaded.camera.fx;
  frame->fy = loaded.camera.fy;
  frame->cx = loaded.camera.cx;
  frame->cy = loaded.camera.cy;
  return frame;
}

std::shared_ptr<const SceneFrame> SceneSource::frame(int index) {
  const auto kept = std::find_if(kept_.begin(), kept_.end(),
                                 [&](const auto& entry) { return entry.first == index; });
  if (kept != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, kept);
    return kept_.front().second;
  }
  auto loaded = load(image_id(index));
  if (!kept_.empty()) {
    const SceneFrame& other = *kept_.front().second;
    if (loaded->width != other.width || loaded->height != other.height ||
        loaded->gray.empty() != other.gray.empty()) {
      throw DatasetError(scene_.path + ": image " + std::to_string(loaded->image_id) +
                         " differs in size or kind from the others");
    }
  }
  kept_.emplace_front(index, std::move(loaded));
  if (kept_.size() > kKeptMax) kept_.pop_back();
  return kept_.front().second;
}

}  // namespace binpick::sim
