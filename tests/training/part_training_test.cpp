#include "training/part_training.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/bracket.hpp"
#include "thread_pool.hpp"

namespace binpick::app {
namespace {

train::TrainOptions quick_options() {
  train::TrainOptions options;
  options.camera = bracket_camera();
  options.distance_min_mm = 420;
  options.distance_max_mm = 560;
  options.samples = 20;
  options.roll_interval_deg = 10;
  options.tree_depths = 3;
  return options;
}

TEST(PileMaker, MakesTheSamePilesOnAnyNumberOfThreads) {
  const PileMaker maker(bracket_part(), quick_options(), {});
  SerialPool one;
  ThreadPool two(2);
  const auto a = maker.make(2, 7, one);
  const auto b = maker.make(2, 7, two);
  const auto other = maker.make(1, 8, one);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(a[i].frame.depth_mm, b[i].frame.depth_mm);
    EXPECT_EQ(a[i].frame.intensity, b[i].frame.intensity);
  }
  EXPECT_NE(a[0].frame.depth_mm, a[1].frame.depth_mm);
  EXPECT_NE(a[0].frame.depth_mm, other[0].frame.depth_mm);
}

// Real lengths come out, although the simulation has its own: of faces turned to the
// camera, of parts that can be seen, the middle lies on the measured surface, at the distances
// trained for.
TEST(PileMaker, TruthAndDepthAgreeInMillimetres) {
  const train::TrainOptions options = quick_options();
  const PileMaker maker(bracket_part(), options, {});
  SerialPool pool;
  int visible = 0;
  for (const SimulatedPile& pile : maker.make(2, 3, pool)) {
    const CameraIntrinsics& camera = pile.frame.camera;
    for (const drivers::TruthInstance& part : pile.truth) {
      if (part.visible_fraction < 0.9) continue;
      ++visible;
      EXPECT_GT(part.T_cam_obj.t_mm.z(), options.distance_min_mm - 60);
      EXPECT_LT(part.T_cam_obj.t_mm.z(), options.distance_max_mm + 60);
      int measured = 0, near = 0;
      const train::Mesh mesh = bracket_mesh();
      for (const auto& t : mesh.triangles) {
        const auto corner = [&](int k) -> Vec3 {
          return part.T_cam_obj *
                 mesh.vertices_mm[t[static_cast<std::size_t>(k)]].cast<double>().eval();
        };
        const Vec3 p = (corner(0) + corner(1) + corner(2)) / 3;
        const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
        if (normal.dot(p.normalized()) > -0.5) continue;
        const int x = static_cast<int>(std::lround(camera.fx * p.x() / p.z() + camera.cx));
        const int y = static_cast<int>(std::lround(camera.fy * p.y() / p.z() + camera.cy));
        if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
        const float z = pile.frame.view().depth_mm.at(x, y);
        if (z <= 0) continue;
        ++measured;
        near += std::abs(z - p.z()) < 2;
      }
      EXPECT_GE(3 * near, measured);  // the part hides some of itself
    }
  }
  EXPECT_GE(visible, 3);
}

TEST(PartTraining, EndsWithACalibratedAndTestedModel) {
  ThreadPool pool(2);
  std::vector<std::string> steps;
  std::vector<double> shares;  // of the last step
  const TrainedPart trained =
      train_part(bracket_part(), quick_options(), {.calibration_piles = 2, .test_piles = 1}, pool,
                 [&](const std::string& step, double share) {
                   if (steps.empty() || steps.back() != step) {
                     steps.push_back(step);
                     shares.clear();
                   }
                   shares.push_back(share);
                 });
  EXPECT_EQ(steps, (std::vector<std::string>{"training", "calibration", "self-test"}));
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.front(), 0);
  EXPECT_EQ(shares.back(), 1);
  const Result<ObjectModel> model = ObjectModel::parse(trained.model);
  ASSERT_TRUE(model.ok());
  const ModelTrials& trials = model.value().trials();
  EXPECT_EQ(trials.calibration_piles, 2);
  EXPECT_FALSE(trials.with_intensity.slope == 1 && trials.with_intensity.offset == 0);
  ASSERT_TRUE(trained.self_test.has_value());
  EXPECT_EQ(trials.self_test.piles, 1);
  EXPECT_EQ(trials.self_test.instances, trained.self_test->record.instances);
  EXPECT_GT(trials.self_test.instances, 0);
  EXPECT_GT(trials.self_test.recall, 0.3);
  EXPECT_GT(trials.self_test.precision, 0.5);

  SerialPool serial;
  const TrainedPart again = train_part(bracket_part(), quick_options(),
                                       {.calibration_piles = 2, .test_piles = 1}, serial, {});
  EXPECT_EQ(again.model, trained.model);
}

TEST(PartTraining, WithoutPilesIsTrainingAlone) {
  ThreadPool pool(2);
  const TrainedPart trained = train_part(bracket_part(), quick_options(),
                                         {.calibration_piles = 0, .test_piles = 0}, pool, {});
  EXPECT_EQ(trained.model, train::train_model(bracket_part(), quick_options(), pool, {}));
  EXPECT_FALSE(trained.self_test.has_value());
}

}  // namespace
}  // namespace binpick::app
