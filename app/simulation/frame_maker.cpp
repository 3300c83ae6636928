#include "simulation/frame_maker.hpp"

#include <algorithm>
#include <cmath>

#include "simulation/shading.hpp"
#include "simulation/simplified_mesh.hpp"

namespace binpick::simulation {
namespace {

void grow(PixelBox& box, int x, int y) {
  if (box.width < 0) {
    box = {x, y, 1, 1};
    return;
  }
  const int x1 = std::max(box.x + box.width, x + 1);
  const int y1 = std::max(box.y + box.height, y + 1);
  box.x = std::min(box.x, x);
  box.y = std::min(box.y, y);
  box.width = x1 - box.x;
  box.height = y1 - box.y;
}

std::vector<InstanceTruth> make_truth(const Scene& scene, const std::vector<Part>& kinds,
                                      const View& view, const TrueView& seen,
                                      const std::vector<std::uint16_t>& depth) {
  std::vector<InstanceTruth> out(scene.parts.size());
  for (std::size_t i = 0; i < seen.body.size(); ++i) {
    if (seen.body[i] < 0) continue;
    const int part = scene.bodies[static_cast<std::size_t>(seen.body[i])].part;
    if (part < 0) continue;
    InstanceTruth& truth = out[static_cast<std::size_t>(part)];
    ++truth.px_count_visib;
    if (depth[i] > 0) ++truth.px_count_valid;
    grow(truth.bbox_visib, static_cast<int>(i) % view.width, static_cast<int>(i) / view.width);
  }
  ZBuffer alone(view.width, view.height);
  for (const auto& body : scene.bodies) {
    if (body.part < 0) continue;
    const auto part = static_cast<std::size_t>(body.part);
    InstanceTruth& truth = out[part];
    alone.clear();
    rasterise(scene.soup, body.first, body.last, view, alone);
    for (int y = 0; y < view.height; ++y) {
      for (int x = 0; x < view.width; ++x) {
        if (alone.triangle[alone.index(x, y)] < 0) continue;
        ++truth.px_count_all;
        grow(truth.bbox_obj, x, y);
      }
    }
    truth.obj_id = kinds[scene.parts[part].kind].obj_id;
    truth.T_cam_obj = view.T_view_world * scene.parts[part].T_world_obj;
    truth.visib_fract =
        truth.px_count_all > 0 ? static_cast<double>(truth.px_count_visib) / truth.px_count_all : 0;
  }
  return out;
}

// Cutting takes time in proportion to the triangles, and these are finer than the pieces anyway.
constexpr std::size_t kCollisionTrianglesMax = 3000;

}  // namespace

FrameMaker::FrameMaker(const std::vector<Part>& parts, const FrameParams& params)
    : parts_(parts), params_(params) {
  for (const auto& part : parts) {
    CollisionShape shape;
    shape.pieces =
        convex_pieces(simplified(part.mesh, kCollisionTrianglesMax), ConvexPiecesParams{});
    double solid = 0;
    for (const auto& piece : shape.pieces) solid += hull_volume(piece);
    const Bounds box = bounds(part.mesh);
    shape.radius_mm = (box.max - box.min).norm() / 2;
    // Between the solid and its hull: neighbours reach into hollows, but not everywhere.
    fill_volumes_.push_back(0.5 * (solid + hull_volume(part.mesh.vertices)));
    shapes_.push_back(std::move(shape));
  }
}

std::vector<std::size_t> FrameMaker::draw_kinds(const std::vector<std::size_t>& kinds,
                                                Rng& rng) const {
  double mean_volume = 0;
  for (std::size_t k : kinds) mean_volume += fill_volumes_[k] / static_cast<double>(kinds.size());
  const BinSize& bin = params_.bin;
  const double room = bin.length * bin.width * bin.height;
  const double wanted = 0.31 * room / mean_volume * rng.uniform(0.8, 1.15);
  const int count =
      params_.part_count > 0 ? params_.part_count : std::clamp(static_cast<int>(wanted), 8, 40);
  std::vector<std::size_t> out;
  for (int i = 0; i < count; ++i) out.push_back(kinds[static_cast<std::size_t>(i) % kinds.size()]);
  for (std::size_t i = out.size(); i > 1; --i) {
    std::swap(out[i - 1], out[static_cast<std::size_t>(rng.below(static_cast<int>(i)))]);
  }
  return out;
}

Frame FrameMaker::make(const std::vector<std::size_t>& kinds, std::uint64_t seed,
                       const FrameSetting& setting) const {
  const CameraParams& camera = setting.camera;
  Rng rng(seed);
  const std::vector<std::size_t> falling = draw_kinds(kinds, rng);
  const std::vector<PlacedPart> placed = make_pile(shapes_, falling, params_.bin, rng.fork(1));
  const Scene scene = make_scene(parts_, placed, params_.bin, setting.as_made, rng.fork(2));
  Frame frame;
  frame.view = make_camera(camera, params_.bin, rng.fork(3));
  frame.roi = bin_roi(frame.view, params_.bin, 0, 0);
  const TrueView seen = make_true_view(scene, frame.view);
  const Roi window = bin_roi(frame.view, params_.bin, 100, 75);
  const Roi shaded = params_.gray_everywhere ? Roi{0, 0, camera.width, camera.height} : window;
  const Radiance radiance = Shader(scene, frame.view, rng.fork(4)).render(shaded);
  const auto exposure = static_cast<float>(std::exp(0.18 * rng.normal()));
  frame.gray = expose(radiance, frame.view, exposure, rng.fork(5));
  frame.depth =
      sense_depth(scene, frame.view, seen, radiance, exposure, window, setting.sensor, rng.fork(6));
  frame.instances = make_truth(scene, parts_, frame.view, seen, frame.depth);
  return frame;
}

}  // namespace binpick::simulation
