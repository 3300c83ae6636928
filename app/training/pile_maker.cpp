#include "training/pile_maker.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "simulation/simplified_mesh.hpp"
#include "simulation/variation.hpp"

namespace binpick::app {
namespace {

using simulation::BinSize;
using simulation::CameraParams;
using simulation::DepthSensorParams;
using simulation::Rng;

// Physics, light and noise of the simulation suit parts of about this diameter.
constexpr double kDiameterInSimulation_mm = 80;
// More triangles cost much and change little of what a sensor sees.
constexpr std::size_t kTrianglesMax = 12000;
// The bin takes at most this share of the image.
constexpr double kImageShareMax = 0.85;
constexpr double kBinInDiametersMin = 2;

std::vector<simulation::Part> part_of(const train::Mesh& mesh, double scale) {
  simulation::Part part;
  part.obj_id = kPileObject;
  for (const auto& v : mesh.vertices_mm) part.mesh.add_vertex(v.cast<double>() * scale);
  for (const auto& t : mesh.triangles) {
    part.mesh.add_triangle(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
  }
  part.mesh = simulation::simplified(part.mesh, kTrianglesMax);
  return {part};
}

// The bin that piles are usually made in, smaller where the camera could not see all of it.
BinSize bin_of(const CameraIntrinsics& camera, double distance_mm) {
  BinSize bin;
  const double room_mm =
      kImageShareMax * distance_mm * std::min(camera.width / camera.fx, camera.height / camera.fy);
  const double shrink = std::clamp(room_mm / bin.length,
                                   kBinInDiametersMin * kDiameterInSimulation_mm / bin.length, 1.0);
  bin.length *= shrink;
  bin.width = std::max(bin.width * shrink, 1.6 * kDiameterInSimulation_mm);
  return bin;
}

simulation::FrameParams params_of(const BinSize& bin) {
  simulation::FrameParams params;
  params.bin = bin;
  params.gray_everywhere = false;
  return params;
}

drivers::LoadedFrame loaded(const simulation::Frame& frame, const DepthSensorParams& sensor,
                            double scale, const CameraIntrinsics& camera) {
  drivers::LoadedFrame out;
  out.camera = camera;
  out.depth_scale_mm = sensor.unit_mm / scale;
  out.roi = {frame.roi.x, frame.roi.y, frame.roi.width, frame.roi.height};
  out.intensity.assign(frame.gray.begin(), frame.gray.end());
  out.depth_mm.reserve(frame.depth.size());
  for (const std::uint16_t d : frame.depth) {
    out.depth_mm.push_back(static_cast<float>(d * out.depth_scale_mm));
  }
  return out;
}

}  // namespace

PileMaker::PileMaker(const train::ImportedMesh& part, const train::TrainOptions& options,
                     std::optional<simulation::SensorKind> kind)
    : kinds_(kind ? std::vector{*kind}
                  : std::vector(simulation::kSensorKinds.begin(), simulation::kSensorKinds.end())),
      scale_(kDiameterInSimulation_mm / train::mesh_bounds(part.mesh).diameter_mm),
      camera_(options.camera),
      distance_min_mm_(options.distance_min_mm),
      distance_max_mm_(options.distance_max_mm),
      bin_(bin_of(options.camera, options.distance_min_mm * scale_)),
      parts_(part_of(part.mesh, scale_)),
      maker_(parts_, params_of(bin_)) {}

SimulatedPile PileMaker::make_one(std::uint64_t seed, simulation::SensorKind kind) const {
  Rng rng(seed);
  CameraParams camera;
  camera.width = camera_.width;
  camera.height = camera_.height;
  camera.fx = camera_.fx, camera.fy = camera_.fy;
  camera.cx = camera_.cx, camera.cy = camera_.cy;
  // Where the parts lie, below the rim, is within the distances trained for as far as that goes.
  const double near_mm = distance_min_mm_ * scale_;
  const double far_mm = std::max(near_mm, distance_max_mm_ * scale_ - bin_.height);
  camera.distance_mm = rng.uniform(near_mm, far_mm);
  simulation::FrameSetting setting = simulation::varied_setting(camera, kind, rng);
  setting.sensor.baseline_mm *= scale_;
  setting.sensor.unit_mm *= scale_;
  const simulation::Frame frame = maker_.make({0}, rng.next(), setting);

  SimulatedPile pile;
  pile.frame = loaded(frame, setting.sensor, scale_, camera_);
  for (const simulation::InstanceTruth& truth : frame.instances) {
    drivers::TruthInstance instance;
    instance.obj_id = kPileObject;
    instance.T_cam_obj = truth.T_cam_obj;
    instance.T_cam_obj.t_mm /= scale_;
    instance.visible_fraction = truth.visib_fract;
    pile.truth.push_back(instance);
  }
  return pile;
}

std::vector<SimulatedPile> PileMaker::make(int count, std::uint64_t seed, WorkerPool& pool,
                                           const train::TrainProgress& progress) const {
  Rng rng(seed);
  std::vector<std::uint64_t> seeds;
  for (int i = 0; i < count; ++i) seeds.push_back(rng.next());
  std::vector<SimulatedPile> piles(static_cast<std::size_t>(count));
  std::atomic<int> done{0};
  pool.parallel_for(count, [&](int i, int thread) {
    const auto at = static_cast<std::size_t>(i);
    piles[at] = make_one(seeds[at], kinds_[at % kinds_.size()]);
    const int now = ++done;
    if (progress && thread == 0) progress(static_cast<double>(now) / count);
  });
  return piles;
}

}  // namespace binpick::app
