// The scenes that a simulated sensor looks at: the frames of one scene of a BOP-layout folder, in
// the order of their image ids. Depth keeps the codes of its 16-bit PNG, so that what arrives can
// be compared with the file byte by byte. Faults are DatasetErrors. Thread: one at a time.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "binpick/drivers/bop_dataset.hpp"

namespace binpick::sim {

struct SceneFrame {
  int image_id = 0;
  int width = 0, height = 0;
  std::vector<std::uint16_t> depth_codes;  // times depth_scale is mm; 0 is no measurement
  std::vector<std::uint8_t> gray;          // empty where the scene has none
  double depth_scale = 1;                  // mm
  double fx = 0, fy = 0, cx = 0, cy = 0;   // px
};

// Images are decoded when they are first asked for; those used last are kept.
class SceneSource {
 public:
  // `folder` is a data set (its first split with scenes is taken, `test` before others), or a split
  // of one. Without scene_id the first scene is taken. All frames have one size and one
  // depth_scale, as those of one sensor do; intrinsics may differ. Refuses a folder without frames.
  SceneSource(const std::string& folder, std::optional<int> scene_id);

  int count() const { return static_cast<int>(image_ids_.size()); }
  int image_id(int index) const { return image_ids_[static_cast<std::size_t>(index)]; }
  std::shared_ptr<const SceneFrame> frame(int index);

 private:
  std::shared_ptr<const SceneFrame> load(int image_id) const;

  std::unique_ptr<drivers::BopDataset> dataset_;
  drivers::BopScene scene_;
  std::vector<int> image_ids_;
  std::list<std::pair<int, std::shared_ptr<const SceneFrame>>> kept_;  // newest first
};

}  // namespace binpick::sim
