// Whether depth tells two poses apart, on rendered parts.
#include "eval/tell_apart.hpp"

#include <gtest/gtest.h>

#include <random>

#include "binpick/geometry/angle.hpp"

namespace binpick::app {
namespace {

const CameraIntrinsics kCamera{320, 240, 800, 800, 159.5, 119.5};

void add_prism(train::Mesh& mesh, int sides, double radius, double z0, double z1) {
  const auto base = static_cast<std::uint32_t>(mesh.vertices_mm.size());
  for (int i = 0; i < sides; ++i) {
    const double a = 2 * kPi * i / sides;
    for (const double z : {z0, z1})
      mesh.vertices_mm.push_back(Vec3(radius * std::cos(a), radius * std::sin(a), z).cast<float>());
  }
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = base + 2 * i, b = base + 2 * ((i + 1) % n);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    if (i == 0 || i + 1 == n) continue;
    mesh.triangles.push_back({base, b, a});
    mesh.triangles.push_back({base + 1, a + 1, b + 1});
  }
}

// A hexagonal head at -z, on a shaft that is round but for its 48 sides.
train::Mesh bolt() {
  train::Mesh mesh;
  add_prism(mesh, 6, 11, -20, -10);
  add_prism(mesh, 48, 5, -10, 30);
  return mesh;
}

struct Depth {
  std::vector<float> mm;
  Frame frame() const {
    Frame frame;
    frame.depth_mm = {mm.data(), kCamera.width, kCamera.height, kCamera.width};
    frame.camera = kCamera;
    return frame;
  }
};

// The part as measured, on a table, with noise; above `hidden_below_row` something stands in front.
Depth measured(const train::Mesh& mesh, const Pose& T, int hidden_above_row = 0) {
  train::Renderer renderer(mesh, kCamera.width, kCamera.height);
  train::RenderedView view;
  renderer.render(kCamera, T, view);
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0, 0.3f);
  Depth depth;
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const float z = view.depth_mm[static_cast<std::size_t>(y * kCamera.width + x)];
      const float behind = z > 0 ? z : 480.0f;
      depth.mm.push_back((y < hidden_above_row ? 300.0f : behind) + noise(random));
    }
  }
  return depth;
}

// On its side, the head towards the top of the image, rolled about its own axis.
Pose lying(double roll_deg) {
  return {rotation_from_vector(Vec3(-kPi / 2, 0, 0)) *
              rotation_from_vector(Vec3(0, 0, roll_deg * kDegree)),
          Vec3(0, 0, 450)};
}

TEST(TellApart, SeesTheRollOfAVisibleHead) {
  const train::Mesh mesh = bolt();
  PoseComparer comparer;
  const Depth depth = measured(mesh, lying(0));
  const PoseComparison c = comparer.compare(depth.frame(), mesh, lying(0), lying(30));
  EXPECT_NEAR(c.noise_mm, 0.3, 0.1);
  EXPECT_GT(c.measured_share(), 0.95);
  EXPECT_GT(c.advantage(), 0.03);
  const PoseComparison near = comparer.compare(depth.frame(), mesh, lying(0), lying(8));
  EXPECT_GT(near.advantage(), 0.01) << "what the loss of a part to the data goes by";
  const PoseComparison same = comparer.compare(depth.frame(), mesh, lying(0), lying(60));
  EXPECT_NEAR(same.advantage(), 0, 0.01) << "a turn that the head does not show";
}

TEST(TellApart, DoesNotSeeTheRollOfAHiddenHead) {
  const train::Mesh mesh = bolt();
  PoseComparer comparer;
  const Vec2 neck = kCamera.project(lying(0) * Vec3(0, 0, -9.5));
  const Depth depth = measured(mesh, lying(0), static_cast<int>(neck.y()));
  const PoseComparison c = comparer.compare(depth.frame(), mesh, lying(0), lying(30));
  EXPECT_NEAR(c.advantage(), 0, 0.01);
  EXPECT_GT(c.silhouette_px, c.measured_px) << "what is in front is no measurement of the part";
}

TEST(TellApart, FavoursTheOtherPoseWhereItIsRight) {
  const train::Mesh mesh = bolt();
  PoseComparer comparer;
  const Depth depth = measured(mesh, lying(0));
  Pose beside = lying(0);
  beside.t_mm.x() += 4;
  EXPECT_LT(comparer.compare(depth.frame(), mesh, beside, lying(0)).advantage(), -0.02);
}

TEST(TellApart, SaysNothingOfWhatIsOutsideTheImage) {
  const train::Mesh mesh = bolt();
  PoseComparer comparer;
  const Depth depth = measured(mesh, lying(0));
  Pose away = lying(0);
  away.t_mm.x() += 5000;
  const PoseComparison c = comparer.compare(depth.frame(), mesh, away, away);
  EXPECT_EQ(c.silhouette_px, 0);
  EXPECT_EQ(c.advantage(), 0);
}

TEST(PixelCost, CountsOnlyWhatLiesBehindAsAContradiction) {
  EXPECT_EQ(pixel_cost(500, 500, 1), 0);
  EXPECT_EQ(pixel_cost(500, 0, 1), 0.5) << "not rendered there";
  EXPECT_EQ(pixel_cost(480, 500, 1), 0.5) << "something in front";
  EXPECT_EQ(pixel_cost(520, 500, 1), 1);
  EXPECT_GT(pixel_cost(500.6, 500, 1), pixel_cost(500.3, 500, 1));
}

}  // namespace
}  // namespace binpick::app
