// One bracket on a plane, as the pose steps see it.
#pragma once

#include "bracket.hpp"
#include "pose/hypothesis.hpp"
#include "pose/scene.hpp"

namespace binpick {

struct SeenBracket {
  explicit SeenBracket(const Pose& T_cam_obj, const ObjectModel& part = bracket_model(),
                       double noise_mm = 0.2)
      : model(part),
        images(render_brackets(bracket_camera(), {T_cam_obj}, noise_mm)),
        plan{images.camera.width, images.camera.height, 3, 64, {}},
        arena(FeaturePyramid::footprint(plan) + symmetry_bytes()),
        pyramid(plan, arena),
        symmetries{SymmetryTransforms(model, arena)},
        truth{T_cam_obj.R, T_cam_obj * model.centre_mm()} {
    look();
  }
  // At the images as they are now.
  void look() { look_at(images.frame()); }
  void without_depth() {
    Frame frame = images.frame();
    frame.depth_mm = {};
    look_at(frame);
  }
  Scene scene() const { return Scene(pyramid, kernels.pose); }
  // The scene outlives the context.
  PoseContext context(const Scene& scene) { return {{&model, 1}, symmetries, scene, pool, {}}; }

  SerialPool pool;
  simd::KernelTable kernels = simd::make_kernel_table(Isa::kBest);
  const ObjectModel& model;
  BracketScene images;
  PyramidPlan plan;
  Arena arena;
  FeaturePyramid pyramid;
  std::vector<SymmetryTransforms> symmetries;
  Pose truth;  // of the part's centre

 private:
  void look_at(const Frame& frame) {
    pyramid.build(frame, {0, 0, images.camera.width / 4 * 4, images.camera.height / 4 * 4},
                  NormalCodebook::kHemisphere, kernels, pool);
  }
  std::size_t symmetry_bytes() const {
    ArenaPlan counted;
    SymmetryTransforms::plan(model, counted);
    return counted.bytes;
  }
};

}  // namespace binpick
