// Convergence of ICP and of the last refinement from perturbed poses, on rendered depth.
#include "pose/icp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <memory>
#include <random>
#include <vector>

#include "bracket.hpp"
#include "pose/refine.hpp"
#include "pose/scene.hpp"

namespace binpick {
namespace {

constexpr int kTrials = 100;

// One part, and what the pose stages see of it.
struct OnePart {
  explicit OnePart(const Pose& T_cam_obj, double noise_mm = 0)
      : images(render_brackets(bracket_camera(), {T_cam_obj}, noise_mm)),
        plan{images.camera.width, images.camera.height, 3, 64, {}},
        arena(FeaturePyramid::footprint(plan)),
        pyramid(plan, arena),
        truth{T_cam_obj.R, T_cam_obj * bracket_model().centre_mm()} {
    SerialPool pool;
    pyramid.build(images.frame(), {0, 0, images.camera.width / 4 * 4, images.camera.height / 4 * 4},
                  NormalCodebook::kHemisphere, simd::make_kernel_table(Isa::kBest), pool);
  }
  Scene scene() const { return Scene(pyramid); }

  BracketScene images;
  PyramidPlan plan;
  Arena arena;
  FeaturePyramid pyramid;
  Pose truth;  // of the part's centre
};

// Up to the given angle and shift, evenly in size, in random directions.
Pose perturbed(const Pose& T, double angle_deg, double shift_mm, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0, 1);
  const Vec3 w = share(random) * angle_deg * kDegree * random_unit(random);
  const Vec3 v = share(random) * shift_mm * random_unit(random);
  return left_increment(T, w, v, T.t_mm);
}

// As a detector runs it.
IcpParams icp_params(const Pose& T) {
  const double diameter_mm = bracket_model().info().diameter_mm;
  IcpParams params;
  params.gate_start_mm = std::max(0.08 * diameter_mm, 0.004 * T.t_mm.z());
  params.gate_end_mm = std::max(0.02 * diameter_mm, 0.002 * T.t_mm.z());
  return params;
}

RefineParams refine_params(const Pose& T) {
  RefineParams params;
  params.depth_gate_mm = std::max(0.02 * bracket_model().info().diameter_mm, 0.002 * T.t_mm.z());
  return params;
}

// Errors of all trials of one stage.
struct Errors {
  std::vector<PoseError> all;

  int within(double angle_deg, double shift_mm) const {
    return static_cast<int>(std::count_if(
        all.begin(), all.end(), [=](const PoseError& e) { return e.within(angle_deg, shift_mm); }));
  }
  void print(const char* stage) const {
    std::vector<double> angles, shifts;
    for (const PoseError& e : all) {
      angles.push_back(e.angle_deg);
      shifts.push_back(e.shift_mm);
    }
    std::sort(angles.begin(), angles.end());
    std::sort(shifts.begin(), shifts.end());
    std::printf(
        "[ measured ]   %-7s p50 %.2f deg %.2f mm, p90 %.2f deg %.2f mm, p95 %.2f deg "
        "%.2f mm\n",
        stage, angles[kTrials / 2], shifts[kTrials / 2], angles[kTrials * 9 / 10],
        shifts[kTrials * 9 / 10], angles[kTrials * 95 / 100], shifts[kTrials * 95 / 100]);
  }
};

struct Measured {
  Errors icp, refined;
};

// Parts at these tilts in turn; ICP, and then refinement from where it ended.
Measured measure(std::initializer_list<double> tilts_deg, double angle_deg, double shift_share,
                 double noise_mm) {
  std::mt19937 random(11);
  std::vector<std::unique_ptr<OnePart>> parts;
  for (const double tilt : tilts_deg) {
    const Pose T = bracket_pose(tilt, 3 * tilt, 5 * tilt, {-20, 10 - tilt / 2, 500});
    parts.push_back(std::make_unique<OnePart>(T, noise_mm));
  }
  const ObjectModel& model = bracket_model();
  const double shift_mm = shift_share * model.info().diameter_mm;
  Measured out;
  for (int i = 0; i < kTrials; ++i) {
    const OnePart& part = *parts[static_cast<std::size_t>(i) % parts.size()];
    const Scene scene = part.scene();
    Pose T = perturbed(part.truth, angle_deg, shift_mm, random);
    icp(model, scene, icp_params(T), T);
    out.icp.all.push_back(pose_error(T, part.truth));
    refine(model, scene, refine_params(T), T);
    out.refined.all.push_back(pose_error(T, part.truth));
  }
  std::printf("[ measured ] from up to %.0f deg and %.0f %% of the diameter, noise %.1f mm\n",
              angle_deg, 100 * shift_share, noise_mm);
  out.icp.print("icp");
  out.refined.print("refined");
  return out;
}

// Three faces in sight: depth alone holds the pose.
constexpr std::initializer_list<double> kTilted_deg = {20, 35, 44};
// The plate across the view: depth alone lets it slide, until the contour holds it.
constexpr std::initializer_list<double> kFrontal_deg = {5};

TEST(Icp, ReturnsToTheTruthFrom8Degrees) {
  const Measured m = measure(kTilted_deg, 8, 0.06, 0);
  EXPECT_GE(m.icp.within(0.3, 0.3), 90);
  EXPECT_GE(m.refined.within(0.3, 0.3), 95);
}

TEST(Icp, ReachesTheBasinThatItStates) {
  const Measured m = measure(kTilted_deg, 10, 0.1, 0);
  EXPECT_GE(m.icp.within(0.3, 0.3), 85);
  EXPECT_GE(m.refined.within(0.3, 0.3), 95);
}

TEST(Icp, HoldsUnderDepthNoise) {
  const Measured m = measure(kTilted_deg, 8, 0.06, 0.3);
  EXPECT_GE(m.icp.within(0.3, 0.3), 90);
  EXPECT_GE(m.refined.within(0.3, 0.3), 95);
}

TEST(Refine, HoldsAPlateSeenFromTheFront) {
  EXPECT_GE(measure(kFrontal_deg, 8, 0.06, 0).refined.within(0.3, 0.3), 90);
  // What ICP lets slide farther than the contour is looked for stays there.
  EXPECT_GE(measure(kFrontal_deg, 10, 0.1, 0).refined.within(0.3, 0.3), 65);
}

TEST(Icp, StaysAtTheTruth) {
  const Pose T_cam_obj = bracket_pose(20, 60, 100, {-20, 0, 500});
  const OnePart part(T_cam_obj);
  Pose T = part.truth;
  const IcpResult result = icp(bracket_model(), part.scene(), icp_params(T), T);
  EXPECT_GT(result.pairs, 100);
  EXPECT_LT(result.rms_mm, 0.3);
  EXPECT_TRUE(pose_error(T, part.truth).within(0.3, 0.3));
}

TEST(Icp, LeavesThePoseWhereThereIsNoDepth) {
  OnePart part(bracket_pose(20, 60, 100, {-20, 0, 500}));
  std::fill(part.images.depth_mm.begin(), part.images.depth_mm.end(), 0.0f);
  SerialPool pool;
  part.pyramid.build(part.images.frame(), {0, 0, 480, 360}, NormalCodebook::kHemisphere,
                     simd::make_kernel_table(Isa::kBest), pool);
  Pose T = part.truth;
  EXPECT_EQ(0, icp(bracket_model(), part.scene(), icp_params(T), T).pairs);
  EXPECT_EQ(part.truth.t_mm, T.t_mm);
  EXPECT_FALSE(align_depth(bracket_model(), part.scene(), 40, T));
}

TEST(AlignDepth, FindsTheSurfaceAlongTheRay) {
  const OnePart part(bracket_pose(10, 60, 100, {-20, 0, 500}));
  for (const double off_mm : {-25.0, -10.0, 0.0, 10.0, 25.0}) {
    Pose T = part.truth;
    T.t_mm *= 1 + off_mm / T.t_mm.z();
    ASSERT_TRUE(align_depth(bracket_model(), part.scene(), 40, T)) << off_mm;
    EXPECT_LT((T.t_mm - part.truth.t_mm).norm(), 2) << off_mm;
    EXPECT_LT(T.t_mm.cross(part.truth.t_mm).norm() / T.t_mm.norm(), 1e-6) << "left its ray";
  }
}

}  // namespace
}  // namespace binpick
