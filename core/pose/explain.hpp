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
  // Width and height are of the depth level.
  static std::size_t footprint(int width_max, int height_max, int owners_max, int thread_count);
  SceneOwnership(int width_max, int height_max, int owners_max, int thread_count, Arena& arena);

  void clear(const Scene& scene);
  struct Owned {
    double share = 0;  // of the pose's supported samples, those on cells that are owned already
    int owner = -1;    // of most of them
  };
  // Each of the threads that ask at the same time has its own number.
  Owned owned(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre,
              int thread = 0) const;
  // Cells of an earlier one remain its own. `owner`: 0 to owners_max - 1.
  void claim(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre, int owner);

 private:
  template <class Visit>
  void visit_cells(const ObjectModel& model, const Scene& scene, const Pose& T_cam_centre,
                   Visit&& visit) const;

  std::span<std::uint16_t> owned_;  // 1 + the owner; 0: nobody's
  std::span<int> votes_;            // scratch of each thread: samples on cells of each owner
  std::size_t votes_per_thread_;
  int columns_ = 0, rows_ = 0;
};

}  // namespace binpick
