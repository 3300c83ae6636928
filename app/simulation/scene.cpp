#include "simulation/scene.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"

namespace binpick::simulation {
namespace {

constexpr double kFloorThickness = 4;

void add_box(TriangleMesh& mesh, const Vec3& min, const Vec3& max) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i) {
    mesh.add_vertex({(i & 1) != 0 ? max.x() : min.x(), (i & 2) != 0 ? max.y() : min.y(),
                     (i & 4) != 0 ? max.z() : min.z()});
  }
  constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : kFaces) {
    mesh.add_triangle(first + f[0], first + f[1], first + f[2]);
    mesh.add_triangle(first + f[0], first + f[2], first + f[3]);
  }
}

TriangleMesh make_bench() {
  TriangleMesh mesh;
  add_box(mesh, {-800, -800, -kFloorThickness - 1}, {800, 800, -kFloorThickness});
  return mesh;
}

TriangleMesh make_bin(const BinSize& bin) {
  TriangleMesh mesh;
  const double x = bin.length / 2;
  const double y = bin.width / 2;
  add_box(mesh, {-x - bin.wall, -y - bin.wall, -kFloorThickness}, {x + bin.wall, y + bin.wall, 0});
  add_box(mesh, {-x - bin.wall, -y - bin.wall, 0}, {-x, y + bin.wall, bin.height});
  add_box(mesh, {x, -y - bin.wall, 0}, {x + bin.wall, y + bin.wall, bin.height});
  add_box(mesh, {-x, -y - bin.wall, 0}, {x, -y, bin.height});
  add_box(mesh, {-x, y, 0}, {x, y + bin.wall, bin.height});
  return mesh;
}

void add_body(Scene& scene, const TriangleMesh& mesh,
              const std::vector<std::array<Eigen::Vector3f, 3>>& normals, Body body) {
  body.first = scene.soup.count();
  const Pose& pose = body.T_world_obj;
  const Eigen::Matrix3f R = pose.R.cast<float>();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Eigen::Vector3f, 3> corners;
    std::array<Eigen::Vector3f, 3> turned;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(mesh.triangles[t][k]);
      corners[k] = (pose * mesh.vertices[v]).cast<float>();
      turned[k] = R * normals[t][k];
    }
    scene.soup.corners.push_back(corners);
    scene.soup.normals.push_back(turned);
    scene.soup.body.push_back(static_cast<int>(scene.bodies.size()));
  }
  body.last = scene.soup.count();
  scene.bodies.push_back(body);
}

TriangleMesh made(TriangleMesh mesh, const PartsAsMade& as_made) {
  const Bounds box = bounds(mesh);
  const Vec3 side = box.max - box.min;
  int longest = 0, shortest = 0;
  side.maxCoeff(&longest);
  side.minCoeff(&shortest);
  const double middle = (box.min[longest] + box.max[longest]) / 2;
  for (Vec3& v : mesh.vertices) {
    const double out = 2 * (v[longest] - middle) / side[longest];
    v[shortest] += as_made.bend * side[longest] * out * out;
    v *= as_made.scale;
  }
  return mesh;
}

}  // namespace

Scene make_scene(const std::vector<Part>& kinds, const std::vector<PlacedPart>& placed,
                 const BinSize& bin, const PartsAsMade& as_made, Rng rng) {
  constexpr double kCrease = 0.6;
  Scene scene;
  scene.bin = bin;
  scene.parts = placed;
  const auto body = [&rng](Finish finish, double spread) {
    Body out;
    out.finish = finish;
    out.seed = static_cast<std::uint32_t>(rng.next());
    out.brightness = static_cast<float>(std::exp(spread * rng.normal()));
    return out;
  };
  const TriangleMesh bench = make_bench();
  add_body(scene, bench, corner_normals(bench, kCrease), body(Finish::kBench, 0.15));
  const TriangleMesh box = make_bin(bin);
  add_body(scene, box, corner_normals(box, kCrease), body(Finish::kBin, 0.35));
  std::vector<TriangleMesh> meshes;
  std::vector<std::vector<std::array<Eigen::Vector3f, 3>>> normals;
  for (const auto& kind : kinds) {
    meshes.push_back(made(kind.mesh, as_made));
    normals.push_back(corner_normals(meshes.back(), kCrease));
  }
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const std::size_t kind = placed[i].kind;
    Body part = body(as_made.finish.value_or(kinds[kind].finish), 0.12);
    part.T_world_obj = placed[i].T_world_obj;
    part.part = static_cast<int>(i);
    add_body(scene, meshes[kind], normals[kind], part);
  }
  return scene;
}

View make_camera(const CameraParams& params, const BinSize& bin, Rng rng) {
  const int quarters = rng.below(4);
  const double turn = kPi / 2 * quarters + rng.uniform(-0.09, 0.09);
  const double tilt = params.tilt_max_rad * std::sqrt(rng.uniform());
  const double tilt_to = rng.uniform(0, 2 * kPi);
  const double drawn = params.fx * bin.length / params.bin_length_px * rng.uniform(0.97, 1.04);
  const double distance = params.distance_mm > 0 ? params.distance_mm : drawn;
  View view;
  view.width = params.width;
  view.height = params.height;
  view.fx = params.fx;
  view.fy = params.fy;
  view.cx = params.cx;
  view.cy = params.cy;
  // The world's z towards the camera: half a turn about x, then the tilt about an axis in the
  // image.
  const Mat3 down = Vec3(1, -1, -1).asDiagonal();
  const Vec3 tilt_axis(std::cos(tilt_to), std::sin(tilt_to), 0);
  view.T_view_world.R = Eigen::AngleAxisd(tilt, tilt_axis).toRotationMatrix() * down *
                        Eigen::AngleAxisd(turn, Vec3::UnitZ()).toRotationMatrix();
  const double aside_x = rng.uniform(-6, 6);
  const double aside_y = rng.uniform(-6, 6);
  const Vec3 centre(aside_x, aside_y, bin.height);
  view.T_view_world.t_mm = Vec3(0, 0, distance) - view.T_view_world.R * centre;
  return view;
}

Roi bin_roi(const View& view, const BinSize& bin, int margin_x, int margin_y) {
  double u_min = 1e9;
  double u_max = -1e9;
  double v_min = 1e9;
  double v_max = -1e9;
  for (int k = 0; k < 4; ++k) {
    const Vec3 corner((k & 1) != 0 ? bin.length / 2 : -bin.length / 2,
                      (k & 2) != 0 ? bin.width / 2 : -bin.width / 2, bin.height);
    const Vec3 p = view.T_view_world * corner;
    u_min = std::min(u_min, view.fx * p.x() / p.z() + view.cx);
    u_max = std::max(u_max, view.fx * p.x() / p.z() + view.cx);
    v_min = std::min(v_min, view.fy * p.y() / p.z() + view.cy);
    v_max = std::max(v_max, view.fy * p.y() / p.z() + view.cy);
  }
  const int x0 = std::clamp(static_cast<int>(std::floor(u_min)) - margin_x, 0, view.width - 1);
  const int x1 = std::clamp(static_cast<int>(std::ceil(u_max)) + margin_x, 0, view.width - 1);
  const int y0 = std::clamp(static_cast<int>(std::floor(v_min)) - margin_y, 0, view.height - 1);
  const int y1 = std::clamp(static_cast<int>(std::ceil(v_max)) + margin_y, 0, view.height - 1);
  return {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

}  // namespace binpick::simulation
