// Greedy explanation of the scene: a better pose owns the measured pixels that it explains, without
// depth those that it projects to; what is left decides about the next one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "binpick/base/arena.hpp"
#include "binpick/model/object_model.hpp"
#include "pose/scene.hpp"

namespace binpick {

class SceneOwnership {
 public:
  static std::size_t footprint(int width_max, int height_max);  // of the depth level
  SceneOwnership(int width_max, int height_max, Arena& arena);

  void clear(const Scene& scene);
  // Share of the pose's supported samples that lie on cells owned already.
  double owned_share(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre) const;
  void claim(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre);

 private:
  template <class Visit>
  void visit_cells(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre,
                   Visit&& visit) const;

  std::span<std::uint8_t> owned_;
  int columns_ = 0, rows_ = 0;
};

}  // namespace binpick
