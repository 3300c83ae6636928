// Convergence of both alignments from perturbed poses: on rendered depth with intensity, and on
// contours alone.
#include "pose/align.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <memory>
#include <random>
#include <vector>

#include "pose/contour.hpp"
#include "pose/view_lookup.hpp"
#include "seen_bracket.hpp"

namespace binpick {
namespace {

constexpr int kTrials = 100;

// Up to the given angle and shift, evenly in size, in random directions.
Pose perturbed(const Pose& T, double angle_deg, double shift_mm, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0, 1);
  const Vec3 w = share(random) * angle_deg * kDegree * random_unit(random);
  const Vec3 v = share(random) * shift_mm * random_unit(random);
  return left_increment(T, w, v, T.t_mm);
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
  Errors coarse, fine;
};

// Parts at these tilts in turn; the coarse alignment, and then the fine one from where it ended.
Measured measure(std::initializer_list<double> tilts_deg, double angle_deg, double shift_share,
                 double noise_mm, bool with_depth = true) {
  std::mt19937 random(11);
  std::vector<std::unique_ptr<SeenBracket>> parts;
  for (const double tilt : tilts_deg) {
    const Pose T = bracket_pose(tilt, 3 * tilt, 5 * tilt, {-20, 10 - tilt / 2, 500});
    parts.push_back(std::make_unique<SeenBracket>(T, bracket_model(), noise_mm));
    if (!with_depth) parts.back()->without_depth();
  }
  const ObjectModel& model = bracket_model();
  const double shift_mm = shift_share * model.info().diameter_mm;
  Measured out;
  for (int i = 0; i < kTrials; ++i) {
    const SeenBracket& part = *parts[static_cast<std::size_t>(i) % parts.size()];
    const Scene scene = part.scene();
    Pose T = perturbed(part.truth, angle_deg, shift_mm, random);
    (void)align(model, scene, coarse_alignment(scene), T);
    out.coarse.all.push_back(pose_error(T, part.truth));
    (void)align(model, scene, fine_alignment(scene), T);
    out.fine.all.push_back(pose_error(T, part.truth));
  }
  std::printf("[ measured ] from up to %.0f deg and %.0f %% of the diameter, noise %.1f mm%s\n",
              angle_deg, 100 * shift_share, noise_mm, with_depth ? "" : ", contours alone");
  out.coarse.print("coarse");
  out.fine.print("fine");
  return out;
}

// Three faces in sight: depth alone holds the pose.
constexpr std::initializer_list<double> kTilted_deg = {20, 35, 44};
// The plate across the view: depth alone lets it slide, until the contour holds it.
constexpr std::initializer_list<double> kFrontal_deg = {5};

TEST(Align, ReturnsToTheTruthFrom8Degrees) {
  const Measured m = measure(kTilted_deg, 8, 0.06, 0);
  EXPECT_GE(m.coarse.within(0.3, 0.3), 90);
  EXPECT_GE(m.fine.within(0.3, 0.3), 95);
}

TEST(Align, ReachesTheBasinThatItStates) {
  const Measured m = measure(kTilted_deg, 10, 0.1, 0);
  EXPECT_GE(m.coarse.within(0.3, 0.3), 85);
  EXPECT_GE(m.fine.within(0.3, 0.3), 95);
}

TEST(Align, HoldsUnderDepthNoise) {
  const Measured m = measure(kTilted_deg, 8, 0.06, 0.3);
  EXPECT_GE(m.coarse.within(0.3, 0.3), 90);
  EXPECT_GE(m.fine.within(0.3, 0.3), 95);
}

TEST(Align, HoldsAPlateSeenFromTheFront) {
  EXPECT_GE(measure(kFrontal_deg, 8, 0.06, 0).fine.within(0.3, 0.3), 90);
  // What the coarse alignment lets slide farther than the contour is looked for stays there.
  EXPECT_GE(measure(kFrontal_deg, 10, 0.1, 0).fine.within(0.3, 0.3), 65);
}

TEST(Align, StaysAtTheTruth) {
  const SeenBracket part(bracket_pose(20, 60, 100, {-20, 0, 500}), bracket_model(), 0);
  const Scene scene = part.scene();
  for (const auto& schedule : {coarse_alignment(scene), fine_alignment(scene)}) {
    Pose T = part.truth;
    ASSERT_TRUE(align(bracket_model(), scene, schedule, T));
    EXPECT_TRUE(pose_error(T, part.truth).within(0.3, 0.3));
    const auto gate_mm = static_cast<float>(0.02 * bracket_model().info().diameter_mm);
    simd::EquationSums sums{};
    scene.kernels.surface_equations(
        bracket_model().surface(nearest_viewpoint(bracket_model(), scene.kernels, T)), pose_f(T),
        scene.depth_map, gate_mm, sums);
    EXPECT_GT(sums.count, 100);
    EXPECT_LT(std::sqrt(sums.cost / static_cast<float>(sums.count)), 0.3);
  }
}

TEST(Align, LeavesThePoseWhereThereIsNoDepth) {
  SeenBracket part(bracket_pose(20, 60, 100, {-20, 0, 500}));
  std::fill(part.images.depth_mm.begin(), part.images.depth_mm.end(), 0.0f);
  part.look();
  const Scene scene = part.scene();
  Pose T = part.truth;
  EXPECT_FALSE(align(bracket_model(), scene, coarse_alignment(scene), T));
  EXPECT_EQ(part.truth.t_mm, T.t_mm);
}

TEST(Align, LeavesAPoseBehindTheCamera) {
  for (const bool with_depth : {true, false}) {
    SeenBracket part(bracket_pose(20, 60, 100, {-20, 0, 500}));
    if (!with_depth) part.without_depth();
    const Scene scene = part.scene();
    Pose T = part.truth;
    T.t_mm.z() = -300;
    EXPECT_FALSE(align(bracket_model(), scene, coarse_alignment(scene), T));
    EXPECT_EQ(-300, T.t_mm.z());
  }
}

// Of a part seen by its contours, as PnP sees it.
SeenBracket& seen_by_contours() {
  static SeenBracket once(bracket_pose(30, 40, 20, {-20, 5, 500}));
  once.without_depth();
  return once;
}

// Largest distance in the image between the same points of the part at two poses.
double image_error_px(const Scene& scene, const Pose& a, const Pose& b) {
  const SampleArrays contour =
      bracket_model().contour(nearest_viewpoint(bracket_model(), scene.kernels, a));
  double worst = 0;
  for (int i = 0; i < contour.count; ++i) {
    const Vec3 p(contour.x[i], contour.y[i], contour.z[i]);
    const CameraIntrinsics& camera = scene.intensity.camera;
    worst = std::max(worst, (camera.project(a * p) - camera.project(b * p)).norm());
  }
  return worst;
}

TEST(AlignOnContours, StaysAtTheTruth) {
  const SeenBracket& part = seen_by_contours();
  const Scene scene = part.scene();
  Pose coarse = part.truth, fine = part.truth;
  ASSERT_TRUE(align(bracket_model(), scene, coarse_alignment(scene), coarse));
  ASSERT_TRUE(align(bracket_model(), scene, fine_alignment(scene), fine));
  std::printf("[ measured ] %.2f px off after the coarse, %.2f px after the fine alignment\n",
              image_error_px(scene, coarse, part.truth), image_error_px(scene, fine, part.truth));
  EXPECT_LT(image_error_px(scene, coarse, part.truth), 4) << "no farther than edges are looked for";
  EXPECT_LT(image_error_px(scene, fine, part.truth), 1.5);
}

// From half a template's spacing. What contours hardly tell, distance and tilt, is loose; the
// image is met.
TEST(AlignOnContours, MeetsTheImageFromATemplatesSpacing) {
  const SeenBracket& part = seen_by_contours();
  const Scene scene = part.scene();
  std::mt19937 random(4);
  int met = 0, far = 0;
  for (int i = 0; i < kTrials; ++i) {
    const Pose start = perturbed(part.truth, 5, 0.05 * bracket_model().info().diameter_mm, random);
    Pose T = start;
    const bool aligned = align(bracket_model(), scene, coarse_alignment(scene), T) &&
                         align(bracket_model(), scene, fine_alignment(scene), T);
    met += aligned && image_error_px(scene, T, part.truth) < 1.5;
    far += image_error_px(scene, start, part.truth) > 1.5;
  }
  std::printf("[ measured ] of %d starts %d more than 1.5 px off, %d aligned to within\n", kTrials,
              far, met);
  EXPECT_GT(far, 80);
  EXPECT_GE(met, 90);
}

TEST(AlignOnContours, LeavesThePoseWithoutEdges) {
  SeenBracket part(bracket_pose(30, 40, 20, {-20, 5, 500}));
  std::fill(part.images.gray.begin(), part.images.gray.end(), std::uint8_t{90});
  part.without_depth();
  const Scene scene = part.scene();
  Pose T = part.truth;
  EXPECT_FALSE(align(bracket_model(), scene, coarse_alignment(scene), T));
  EXPECT_EQ(part.truth.t_mm, T.t_mm);
  EXPECT_TRUE(align(bracket_model(), scene, fine_alignment(scene), T)) << "it stays as it is";
  EXPECT_EQ(part.truth.t_mm, T.t_mm);
}

// Only edges of the contour's direction count.
TEST(AlignOnContours, EdgesAcrossTheContourAreDropped) {
  SeenBracket part(bracket_pose(30, 40, 20, {-20, 5, 500}));
  const Scene scene = part.scene();
  const Viewpoint& view = nearest_viewpoint(bracket_model(), scene.kernels, part.truth);
  ContourMatches m;
  place_contour(bracket_model(), view, scene, part.truth, 4, 0, m);
  match_edges(scene, 4, m);
  const auto found = [&] { return std::count(m.edges.found, m.edges.found + m.count, -1); };
  const auto all = found();
  ASSERT_GT(all, 60);
  ContourMatches across = m;
  keep_directed_edges(scene, m);
  EXPECT_GT(found(), all * 3 / 4);
  for (int i = 0; i < across.count; ++i) {
    std::swap(across.places.normal_u[i], across.places.normal_v[i]);
    across.places.normal_u[i] *= -1;
    across.edges.offset_px[i] = 0;
  }
  m = across;
  keep_directed_edges(scene, m);
  EXPECT_LT(found(), all / 4);
}

}  // namespace
}  // namespace binpick
