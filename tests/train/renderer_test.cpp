// Renders shapes whose depth and normals are known in closed form.
#include "binpick/train/renderer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <thread>

#include "binpick/geometry/angle.hpp"
#include "binpick/train/errors.hpp"

namespace binpick::train {
namespace {

const Vec3 kBoxHalf_mm{20, 12.5, 7};

Mesh box() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Vec3 sign((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1);
    mesh.vertices_mm.push_back(sign.cwiseProduct(kBoxHalf_mm).cast<float>());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

Mesh rectangle(float half_x_mm, float half_y_mm) {
  return {{{-half_x_mm, -half_y_mm, 0},
           {half_x_mm, -half_y_mm, 0},
           {half_x_mm, half_y_mm, 0},
           {-half_x_mm, half_y_mm, 0}},
          {{0, 1, 2}, {0, 2, 3}}};
}

Mesh sphere(double radius_mm, unsigned steps) {
  Mesh mesh;
  for (unsigned i = 0; i <= steps; ++i) {
    for (unsigned j = 0; j < steps; ++j) {
      const double polar = kPi * i / steps, around = 2 * kPi * j / steps;
      const Vec3 x(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                   std::cos(polar));
      mesh.vertices_mm.push_back((radius_mm * x).cast<float>());
    }
  }
  const auto index = [=](unsigned i, unsigned j) { return i * steps + j % steps; };
  for (unsigned i = 0; i < steps; ++i) {
    for (unsigned j = 0; j < steps; ++j) {
      mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  }
  return mesh;
}

struct Hit {
  double depth_mm;
  Vec3 normal_cam;
};

// The box by the slab method: where the ray of pixel (u, v) first meets it.
std::optional<Hit> hit_box(const CameraIntrinsics& camera, const Pose& T, double u, double v) {
  const Vec3 origin = T.R.transpose() * -T.t_mm;
  const Vec3 step = T.R.transpose() * camera.unproject(u, v, 1.0);
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (-kBoxHalf_mm[axis] - origin[axis]) / step[axis];
    const double b = (kBoxHalf_mm[axis] - origin[axis]) / step[axis];
    if (std::min(a, b) > enter) {
      enter = std::min(a, b);
      normal = Vec3::Unit(axis) * (step[axis] > 0 ? -1 : 1);
    }
    leave = std::min(leave, std::max(a, b));
  }
  if (enter >= leave) return std::nullopt;
  return Hit{enter, T.R * normal};
}

// Rasterising rounds corners to 1/256 pixel: a pixel this close to an edge may fall on either side.
bool near_edge_of_box(const CameraIntrinsics& camera, const Pose& T, int u, int v) {
  const auto centre = hit_box(camera, T, u, v);
  for (const Vec2& d : {Vec2(0.01, 0), Vec2(-0.01, 0), Vec2(0, 0.01), Vec2(0, -0.01)}) {
    const auto beside = hit_box(camera, T, u + d.x(), v + d.y());
    if (beside.has_value() != centre.has_value()) return true;
    if (beside && beside->normal_cam != centre->normal_cam) return true;
  }
  return false;
}

void expect_box(const RenderedView& view, const CameraIntrinsics& camera, const Pose& T) {
  int seen_count = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      if (near_edge_of_box(camera, T, u, v)) continue;
      const auto i = static_cast<std::size_t>(v * camera.width + u);
      const auto hit = hit_box(camera, T, u, v);
      ASSERT_EQ(view.depth_mm[i] > 0, hit.has_value()) << "pixel " << u << ", " << v;
      if (!hit) {
        ASSERT_EQ(view.normal_cam[i], Eigen::Vector3f(0, 0, 0));
        continue;
      }
      ++seen_count;
      ASSERT_NEAR(view.depth_mm[i], hit->depth_mm, 2e-3) << "pixel " << u << ", " << v;
      ASSERT_LT((view.normal_cam[i].cast<double>() - hit->normal_cam).norm(), 1e-5);
    }
  }
  EXPECT_GT(seen_count, 100);
}

const CameraIntrinsics kCamera{160, 120, 900, 880, 79.3, 61.7};

bool same_bytes(const RenderedView& a, const RenderedView& b) {
  return a.depth_mm == b.depth_mm && a.normal_cam == b.normal_cam;
}

TEST(Renderer, GivesDepthAndNormalsOfABox) {
  Renderer renderer(box(), 160, 120);
  RenderedView view;
  for (int i = 0; i < 12; ++i) {
    const Pose T{rotation_from_vector({0.5 * i, 0.3 - 0.1 * i, 0.21 * i}), {3, -4, 400 + 40.0 * i}};
    renderer.render(kCamera, T, view);
    ASSERT_EQ(view.width, 160);
    ASSERT_EQ(view.height, 120);
    expect_box(view, kCamera, T);
  }
}

TEST(Renderer, TakesAPrincipalPointFarOffTheCentre) {
  Renderer renderer(box(), 160, 120);
  RenderedView view;
  for (const Vec2& c : {Vec2(5.25, 110.5), Vec2(-380.5, 60), Vec2(700.75, -250.25)}) {
    CameraIntrinsics camera = kCamera;
    camera.cx = c.x();
    camera.cy = c.y();
    const Pose T{rotation_from_vector({0.4, -0.7, 1.1}), camera.unproject(80, 60, 500)};
    renderer.render(camera, T, view);
    expect_box(view, camera, T);
  }
}

TEST(Renderer, HasPixelCentresAtIntegerCoordinates) {
  // Edges at u = 9.6 and 12.4, v = 3.9 and 8.1 of a camera with f = 100 px, 100 mm away.
  Renderer renderer(rectangle(1.4f, 2.1f), 32, 32);
  const CameraIntrinsics camera{32, 32, 100, 100, 0, 0};
  RenderedView view;
  renderer.render(camera, {Mat3::Identity(), {11, 6, 100}}, view);
  for (int v = 0; v < 32; ++v) {
    for (int u = 0; u < 32; ++u) {
      const bool inside = u >= 10 && u <= 12 && v >= 4 && v <= 8;
      EXPECT_EQ(view.depth_view().at(u, v) > 0, inside) << "pixel " << u << ", " << v;
    }
  }
}

TEST(Renderer, IsExactOnATiltedPlane) {
  Renderer renderer(rectangle(300, 300), 160, 120);
  const Pose T{rotation_from_vector({0.9, -0.4, 0}), {0, 0, 800}};
  RenderedView view;
  renderer.render(kCamera, T, view);
  const Vec3 n = T.R.col(2);
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      const double expected = n.dot(T.t_mm) / n.dot(kCamera.unproject(u, v, 1.0));
      ASSERT_NEAR(view.depth_view().at(u, v), expected, 2e-3);
    }
  }
}

TEST(Renderer, FollowsASphereWithinItsFacets) {
  const double radius_mm = 30;
  Renderer renderer(sphere(radius_mm, 160), 160, 120);
  const Vec3 centre(4, 2, 450);
  RenderedView view;
  renderer.render(kCamera, {rotation_from_vector({0.3, 1.2, -0.5}), centre}, view);
  int inside_count = 0;
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      const Vec3 ray = kCamera.ray(u, v);
      const double along = ray.dot(centre), beside = (centre - along * ray).norm();
      const float depth = view.depth_view().at(u, v);
      if (beside > radius_mm) {
        ASSERT_EQ(depth, 0);
      } else if (beside < 0.95 * radius_mm) {  // a facet is at most 0.012 mm below the sphere
        ++inside_count;
        const double range = along - std::sqrt(radius_mm * radius_mm - beside * beside);
        ASSERT_NEAR(depth, range * ray.z(), 0.05);
        const Vec3 n = (range * ray - centre).normalized();
        const auto i = static_cast<std::size_t>(v * 160 + u);
        ASSERT_GT(view.normal_cam[i].cast<double>().dot(n), std::cos(0.03));
      }
    }
  }
  EXPECT_GT(inside_count, 5000);
}

TEST(Renderer, TurnsNormalsToTheCameraWhateverTheWinding) {
  Mesh mixed = box();
  for (std::size_t i = 0; i < mixed.triangles.size(); i += 3) {
    std::swap(mixed.triangles[i][0], mixed.triangles[i][1]);
  }
  Renderer renderer(mixed, 160, 120);
  const Pose T{rotation_from_vector({2.0, 0.3, -0.6}), {0, 0, 420}};
  RenderedView view;
  renderer.render(kCamera, T, view);
  expect_box(view, kCamera, T);
}

TEST(Renderer, CutsAPlaneThatRunsThroughTheCamera) {
  // A floor 100 mm below the camera, from 3 m behind it to 3 m ahead.
  Renderer renderer(rectangle(3000, 3000), 160, 120);
  const Pose floor{rotation_from_vector({kPi / 2, 0, 0}), {0, 100, 0}};
  const CameraIntrinsics camera{160, 120, 100, 100, 80, 40};
  RenderedView view;
  renderer.render(camera, floor, view);
  for (int v = 0; v < 120; ++v) {
    const double expected = v > 40 ? 100.0 * 100 / (v - 40) : 0;
    for (int u = 0; u < 160; ++u) {
      if (expected > 2999) continue;
      const float depth = view.depth_view().at(u, v);
      ASSERT_NEAR(depth, expected, 1e-3 + 1e-5 * expected) << "pixel " << u << ", " << v;
      const auto i = static_cast<std::size_t>(v * 160 + u);
      if (depth > 0) {
        ASSERT_LT((view.normal_cam[i] - Eigen::Vector3f(0, -1, 0)).norm(), 1e-5);
      }
    }
  }
}

TEST(Renderer, SeesNothingOfAnObjectBehindOrBesideTheView) {
  Renderer renderer(box(), 160, 120);
  RenderedView view;
  for (const Vec3& t : {Vec3(0, 0, -500), Vec3(400, 0, 500), Vec3(0, -400, 500)}) {
    renderer.render(kCamera, {Mat3::Identity(), {0, 0, 400}}, view);
    renderer.render(kCamera, {Mat3::Identity(), t}, view);
    for (const float depth : view.depth_mm) ASSERT_EQ(depth, 0);
    for (const auto& n : view.normal_cam) ASSERT_EQ(n, Eigen::Vector3f(0, 0, 0));
  }
}

TEST(Renderer, ReusesTheMemoryOfAView) {
  Renderer renderer(box(), 160, 120);
  RenderedView view;
  renderer.render(kCamera, {Mat3::Identity(), {0, 0, 400}}, view);
  const void* depth = view.depth_mm.data();
  const void* normals = view.normal_cam.data();
  CameraIntrinsics small = kCamera;
  small.width = small.height = 40;
  renderer.render(small, {Mat3::Identity(), {0, 0, 300}}, view);
  EXPECT_EQ(view.depth_mm.size(), 1600u);
  renderer.render(kCamera, {Mat3::Identity(), {10, 0, 200}}, view);
  EXPECT_EQ(view.depth_mm.data(), depth);
  EXPECT_EQ(view.normal_cam.data(), normals);
}

TEST(Renderer, GivesTheSameBytesOnTwoThreadsAtOnce) {
  const Mesh mesh = sphere(30, 40);
  const auto pose = [](int i) {
    return Pose{rotation_from_vector({0.11 * i, 0.07 * i, 1}), {0, 0, 300 + 5.0 * i}};
  };
  const auto run = [&](std::vector<RenderedView>& views) {
    Renderer renderer(mesh, 160, 120);
    for (std::size_t i = 0; i < views.size(); ++i) {
      renderer.render(kCamera, pose(static_cast<int>(i)), views[i]);
    }
  };
  std::vector<RenderedView> alone(60), first(60), second(60);
  run(alone);
  std::thread a([&] { run(first); });
  std::thread b([&] { run(second); });
  a.join();
  b.join();
  for (std::size_t i = 0; i < alone.size(); ++i) {
    ASSERT_TRUE(same_bytes(alone[i], first[i])) << "view " << i;
    ASSERT_TRUE(same_bytes(alone[i], second[i])) << "view " << i;
  }
}

TEST(Renderer, MayMoveBetweenThreadsAndStandBesideAnother) {
  const Pose T{rotation_from_vector({0.4, -0.7, 1.1}), {0, 0, 400}};
  auto moved = std::make_unique<Renderer>(box(), 160, 120);
  Renderer other(rectangle(5, 5), 160, 120);
  RenderedView here, there, between;
  moved->render(kCamera, T, here);
  other.render(kCamera, T, between);
  std::thread([&] {
    moved->render(kCamera, T, there);
    moved.reset();
  }).join();
  other.render(kCamera, T, between);
  EXPECT_TRUE(same_bytes(here, there));
  EXPECT_FALSE(same_bytes(here, between));
}

TEST(Renderer, RefusesAMeshItCannotDraw) {
  EXPECT_THROW(Renderer(Mesh{}, 64, 64), RenderError);
  Mesh dangling = box();
  dangling.triangles[3][1] = 8;
  EXPECT_THROW(Renderer(dangling, 64, 64), RenderError);
  EXPECT_THROW(Renderer(rectangle(0, 5), 64, 64), RenderError);
}

}  // namespace
}  // namespace binpick::train
