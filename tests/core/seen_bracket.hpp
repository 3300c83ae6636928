// One bracket on a plane, as the pose stages see it.
#pragma once

#include "bracket.hpp"
#include "pose/part_moves.hpp"
#include "pose/scene.hpp"

namespace binpick {

struct SeenBracket {
  explicit SeenBracket(const Pose& T_cam_obj, const ObjectModel& part = bracket_model(),
                       double noise_mm = 0.2)
      : model(part),
        images(render_brackets(bracket_camera(), {T_cam_obj}, noise_mm)),
        plan{images.camera.width, images.camera.height, 3, 64, {}},
        arena(FeaturePyramid::footprint(plan) + moves_bytes()),
        pyramid(plan, arena),
        moves{PartMoves(model, arena)},
        truth{T_cam_obj.R, T_cam_obj * model.centre_mm()} {
    pyramid.build(images.frame(), {0, 0, images.camera.width / 4 * 4, images.camera.height / 4 * 4},
                  NormalCodebook::kHemisphere, simd::make_kernel_table(Isa::kBest), pool);
  }
  PoseContext context(const Scene& scene) { return {{&model, 1}, moves, scene, pool, {}}; }

  SerialPool pool;
  const ObjectModel& model;
  BracketScene images;
  PyramidPlan plan;
  Arena arena;
  FeaturePyramid pyramid;
  std::vector<PartMoves> moves;
  Pose truth;  // of the part's centre

 private:
  std::size_t moves_bytes() const {
    ArenaPlan counted;
    PartMoves::plan(model, counted);
    return counted.bytes;
  }
};

}  // namespace binpick
