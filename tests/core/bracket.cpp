#include "bracket.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "binpick/train/renderer.hpp"
#include "binpick/train/trainer.hpp"
#include "threads_per_call.hpp"

namespace binpick {
namespace {

using train::Mesh;

constexpr double kPlaneZ_mm = 560;

void add_box(Mesh& mesh, const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_mm.size());
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_mm.push_back(
        {i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z()});
  }
  constexpr std::uint32_t kFaces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                           {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                           {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (const auto& f : kFaces) mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
}

// Upright prism with a top and no bottom.
void add_boss(Mesh& mesh, float x, float y, float z_low, float z_high, float radius) {
  constexpr std::uint32_t kSides = 16;
  const auto first = static_cast<std::uint32_t>(mesh.vertices_mm.size());
  mesh.vertices_mm.push_back({x, y, z_high});
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const float a = 2 * static_cast<float>(kPi) * static_cast<float>(i) / kSides;
    mesh.vertices_mm.push_back({x + radius * std::cos(a), y + radius * std::sin(a), z_low});
    mesh.vertices_mm.push_back({x + radius * std::cos(a), y + radius * std::sin(a), z_high});
  }
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t a = first + 1 + 2 * i, b = first + 1 + 2 * ((i + 1) % kSides);
    mesh.triangles.push_back({a, b, a + 1});
    mesh.triangles.push_back({b, b + 1, a + 1});
    mesh.triangles.push_back({first, a + 1, b + 1});
  }
}

// Bytes at an address that parse() accepts; lives as long as the program.
struct TrainedModel {
  std::vector<std::uint8_t> bytes;
  ObjectModel model;
};

TrainedModel train_bracket() {
  train::TrainOptions options;
  options.camera = bracket_camera();
  options.distance_min_mm = 460;
  options.distance_max_mm = 540;
  options.tilt_max_deg = 50;
  options.samples = 40;
  ThreadsPerCall pool(2);
  std::vector<std::uint8_t> bytes = train::train_model(bracket_part(), options, pool, {});
  Result<ObjectModel> model = ObjectModel::parse(bytes);
  return {std::move(bytes), std::move(model).value()};  // the bytes stay where they are
}

const TrainedModel& trained() {
  static const TrainedModel once = train_bracket();
  return once;
}

}  // namespace

train::ImportedMesh bracket_part() {
  train::ImportedMesh part;
  part.mesh = bracket_mesh();
  part.source_hash = 0xB0A7;
  return part;
}

Mesh bracket_mesh() {
  Mesh mesh;
  add_box(mesh, {-5, -10, 0}, {60, 24, 6});  // base
  add_box(mesh, {-5, -10, 0}, {1, 12, 34});  // upright, narrower than the base
  add_boss(mesh, 40, 10, 6, 20, 8);
  return mesh;
}

CameraIntrinsics bracket_camera() {
  return {480, 360, 800, 800, 241.3, 178.6};
}

const ObjectModel& bracket_model() {
  return trained().model;
}
const std::vector<std::uint8_t>& bracket_model_bytes() {
  return trained().bytes;
}

std::vector<std::uint8_t> tiny_model_bytes() {
  train::TrainOptions options;
  options.camera = bracket_camera();
  options.distance_min_mm = 460;
  options.distance_max_mm = 600;
  options.samples = 10;
  options.tree_depths = 2;
  options.tilt_max_deg = 60;
  options.tilt_jitter_deg = 20;
  options.roll_interval_deg = 30;
  options.roll_jitter_deg = 15;
  SerialPool pool;
  return train::train_model(bracket_part(), options, pool, {});
}

Pose bracket_pose(double tilt_deg, double azimuth_deg, double roll_deg, const Vec3& t_mm) {
  const double a = azimuth_deg * kDegree;
  const Mat3 facing = rotation_from_vector({kPi, 0, 0});  // +z of the part towards the camera
  const Mat3 tilt = rotation_from_vector(tilt_deg * kDegree * Vec3(std::cos(a), std::sin(a), 0));
  return {rotation_from_vector({0, 0, roll_deg * kDegree}) * facing * tilt, t_mm};
}

std::vector<Pose> three_brackets() {
  return {bracket_pose(8, 30, 20, {-75, -35, 510}), bracket_pose(25, 200, 140, {60, -55, 490}),
          bracket_pose(15, 100, 260, {5, 55, 500})};
}

BracketScene render_brackets(const CameraIntrinsics& camera, const std::vector<Pose>& poses,
                             double noise_mm) {
  const auto pixels =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  BracketScene scene{std::vector<float>(pixels, static_cast<float>(kPlaneZ_mm)),
                     std::vector<std::uint8_t>(pixels, 60), camera, poses};
  train::Renderer renderer(bracket_mesh(), camera.width, camera.height);
  train::RenderedView view;
  const Eigen::Vector3f light = Eigen::Vector3f(0.35f, -0.5f, -0.8f).normalized();
  for (const Pose& T : poses) {
    renderer.render(camera, T, view);
    for (std::size_t i = 0; i < pixels; ++i) {
      const float z = view.depth_mm[i];
      if (!(z > 0) || z > scene.depth_mm[i]) continue;
      scene.depth_mm[i] = z;
      const float shade = std::max(0.0f, view.normal_cam[i].dot(light));
      scene.gray[i] = static_cast<std::uint8_t>(90 + 150 * shade);
    }
  }
  if (noise_mm > 0) {
    std::mt19937 random(99);
    std::normal_distribution<float> noise(0, static_cast<float>(noise_mm));
    for (float& z : scene.depth_mm) z += noise(random);
  }
  return scene;
}

}  // namespace binpick
