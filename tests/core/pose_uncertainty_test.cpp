// The covariance of poses in scenes of which it is known what they hold.
#include <gtest/gtest.h>

#include <cmath>

#include "bracket.hpp"
#include "detect/detector_plan.hpp"
#include "pose/uncertainty.hpp"
#include "threads_per_call.hpp"

namespace binpick {
namespace {

// Depth and intensity of a frame as the pose stages see them.
struct SeenScene {
  explicit SeenScene(const BracketScene& from)
      : plan(make_detector_plan({&bracket_model(), 1}, limits_of(from.camera), 1)),
        arena(FeaturePyramid::footprint(plan.pyramid)),
        pyramid(plan.pyramid, arena) {
    SerialPool pool;
    const Frame frame = from.frame();
    pyramid.build(frame, region_of(frame, plan).value(), plan.normal_codebook, kernels, pool);
  }
  static DetectorLimits limits_of(const CameraIntrinsics& camera) {
    DetectorLimits limits;
    limits.image_width = camera.width;
    limits.image_height = camera.height;
    return limits;
  }
  simd::KernelTable kernels = simd::make_kernel_table(Isa::kBest);
  DetectorPlan plan;
  Arena arena;
  FeaturePyramid pyramid;
};

PoseUncertainty uncertainty_at(const BracketScene& scene, const Pose& T_cam_obj) {
  const ObjectModel& model = bracket_model();
  const SeenScene seen(scene);
  Pose T = T_cam_obj;
  T.t_mm += T.R * model.centre_mm();
  return pose_uncertainty(model, Scene(seen.pyramid, seen.kernels.pose), T);
}

TEST(PoseUncertainty, IsSmallWhereThreeFacesAndTheOutlineShow) {
  const Pose pose = bracket_pose(35, 40, 10, Vec3(5, -5, 500));
  const PoseUncertainty u = uncertainty_at(render_brackets(bracket_camera(), {pose}, 0.2), pose);
  EXPECT_TRUE(u.shift_observable);
  EXPECT_TRUE(u.turn_observable);
  EXPECT_GT(u.weak_shift_mm, 0.001);
  EXPECT_LT(u.weak_shift_mm, 1);
  EXPECT_LT(u.weak_turn_rad / kDegree, 1.5);
  EXPECT_NEAR(u.weak_shift.norm(), 1, 1e-6);
  for (int i = 0; i < 6; ++i) EXPECT_GT(u.covariance[static_cast<std::size_t>(7 * i)], 0);
}

TEST(PoseUncertainty, SaysThatNothingHoldsAPoseWhereNothingWasMeasured) {
  const Pose pose = bracket_pose(35, 40, 10, Vec3(5, -5, 500));
  BracketScene scene = render_brackets(bracket_camera(), {pose});
  std::fill(scene.depth_mm.begin(), scene.depth_mm.end(), 0.0f);
  std::fill(scene.gray.begin(), scene.gray.end(), std::uint8_t{90});
  const PoseUncertainty u = uncertainty_at(scene, pose);
  EXPECT_FALSE(u.shift_observable);
  EXPECT_FALSE(u.turn_observable);
  EXPECT_NEAR(u.weak_shift_mm, bracket_model().info().diameter_mm / 4, 0.1);
}

// A plane of the part's colour around it hides the outline: only depth is left, and of a plate seen
// from above that holds height and tilt, not the place on the plane.
TEST(PoseUncertainty, NamesTheDirectionInWhichAPlateSlides) {
  const Pose pose = bracket_pose(0, 0, 0, Vec3(0, 0, 500));
  BracketScene scene = render_brackets(bracket_camera(), {pose});
  std::fill(scene.gray.begin(), scene.gray.end(), std::uint8_t{90});
  const double seen_mm = uncertainty_at(scene, pose).weak_shift_mm;
  const PoseUncertainty u = uncertainty_at(scene, pose);
  EXPECT_LT(std::abs(u.weak_shift.z()), 0.3) << "it slides across the view, not along it";
  const BracketScene with_edges = render_brackets(bracket_camera(), {pose});
  EXPECT_LT(uncertainty_at(with_edges, pose).weak_shift_mm, seen_mm);
}

}  // namespace
}  // namespace binpick
