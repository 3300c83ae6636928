// make_sample_data: renders bins full of parts, with truth, in the BOP layout.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <numeric>
#include <optional>

#include "binpick/geometry/angle.hpp"
#include "bop_writer.hpp"
#include "mesh_files.hpp"
#include "parts.hpp"
#include "simulation/variation.hpp"

namespace {

using namespace binpick::simulation;

struct Options {
  std::string out;
  std::string cad_out;
  std::vector<std::string> mesh_paths;
  int frames = 2;
  int mixed_frames = 1;
  std::uint64_t seed = 1;
  int part_count = 0;
  double tilt_deg_max = 15;
  double shine = 1;
  double image_scale = 1;
  std::optional<SensorKind> kind;  // varied
};

// Seeds of frames do not depend on how many frames are asked for.
std::uint64_t frame_seed(std::uint64_t seed, int scene, int frame) {
  Rng of_set(seed);
  Rng of_scene = of_set.fork(static_cast<std::uint64_t>(scene));
  return of_scene.fork(static_cast<std::uint64_t>(frame)).next();
}

// The same view with so many times more pixels in a row, and as many more in a column.
CameraParams camera_of(const Options& options) {
  CameraParams camera;
  const double scale = options.image_scale;
  camera.width = static_cast<int>(std::lround(camera.width * scale));
  camera.height = static_cast<int>(std::lround(camera.height * scale));
  for (double* focal : {&camera.fx, &camera.fy, &camera.bin_length_px}) *focal *= scale;
  for (double* middle : {&camera.cx, &camera.cy}) *middle = (*middle + 0.5) * scale - 0.5;
  camera.tilt_max_rad = options.tilt_deg_max * binpick::kDegree;
  return camera;
}

// Parts that shine so many times more than usual blind the sensor with so much less light, and are
// measured only where they face it so much more.
DepthSensorParams sensor_for(double shine) {
  DepthSensorParams sensor;
  sensor.glare_level /= shine;
  sensor.grazing_cos_min = std::min(0.9, sensor.grazing_cos_min * shine);
  sensor.grazing_cos_sure = std::min(0.95, sensor.grazing_cos_sure * shine);
  return sensor;
}

void write_scene(const Options& options, const FrameMaker& maker, int scene, int frames,
                 const std::vector<std::size_t>& kinds) {
  SceneWriter writer(options.out, scene);
  for (int i = 0; i < frames; ++i) {
    const std::uint64_t seed = frame_seed(options.seed, scene, i);
    Rng rng(~seed);
    const Frame frame =
        options.kind
            ? maker.make(kinds, seed, varied_setting(camera_of(options), *options.kind, rng))
            : maker.make(kinds, seed);
    writer.add(frame);
    int clear = 0;
    double visible_px = 0, measured_px = 0;
    for (const auto& instance : frame.instances) {
      clear += instance.visib_fract >= 0.7 ? 1 : 0;
      visible_px += instance.px_count_visib;
      measured_px += instance.px_count_valid;
    }
    std::printf(
        "scene %d frame %d: %zu parts, %d of them at least 70 %% visible; %.0f %% without depth\n",
        scene, i, frame.instances.size(), clear,
        visible_px > 0 ? 100 * (1 - measured_px / visible_px) : 0);
    std::fflush(stdout);
  }
  writer.finish();
}

void run(const Options& options) {
  const std::vector<Part> parts =
      options.mesh_paths.empty() ? make_own_parts() : read_parts(options.mesh_paths);
  FrameParams params;
  params.part_count = options.part_count;
  params.setting.camera = camera_of(options);
  params.setting.sensor = sensor_for(options.shine);
  write_models(options.out, parts, params.setting.camera);
  if (!options.cad_out.empty()) {
    std::filesystem::create_directories(options.cad_out);
    for (const auto& part : parts) {
      write_stl(part.mesh,
                (std::filesystem::path(options.cad_out) / (part.name + ".stl")).string());
    }
  }
  const FrameMaker maker(parts, params);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (options.frames > 0) write_scene(options, maker, parts[k].obj_id, options.frames, {k});
  }
  if (options.mixed_frames > 0 && parts.size() > 1) {
    std::vector<std::size_t> all(parts.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    int scene = 0;
    for (const auto& part : parts) scene = std::max(scene, part.obj_id);
    write_scene(options, maker, scene + 1, options.mixed_frames, all);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Renders bins full of parts, with truth, in the BOP layout (lengths in mm)."};
  app.add_option("--out", options.out, "folder of the data set")->required();
  app.add_option("--parts", options.mesh_paths,
                 "mesh files in mm, or bolt for a threaded bolt; tee, clip and hub if left out");
  app.add_option("--frames", options.frames, "frames per part, each a pile of its own")
      ->capture_default_str();
  app.add_option("--mixed-frames", options.mixed_frames, "frames of one more scene with all parts")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "the same seed gives the same data")
      ->capture_default_str();
  app.add_option("--count", options.part_count, "parts in a bin; 0 fills it well")
      ->capture_default_str();
  app.add_option("--tilt-deg-max", options.tilt_deg_max, "largest tilt of the camera")
      ->capture_default_str();
  app.add_option("--shine", options.shine, "how much shinier than usual, and so with less depth")
      ->check(CLI::Range(1.0, 5.0))
      ->capture_default_str();
  app.add_option_function<std::string>(
         "--sensor-kind", [&](const std::string& name) { options.kind = sensor_kind_of(name); },
         "a kind of sensor; its noise, the light, and the parts' finish and size vary then")
      ->check(CLI::IsMember(sensor_kind_names()));
  app.add_option("--image-scale", options.image_scale, "pixels in a row, times the usual 1280")
      ->check(CLI::Range(0.25, 4.0))
      ->capture_default_str();
  app.add_option("--cad-out", options.cad_out, "also write the meshes as STL into this folder");
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_sample_data: %s\n", error.what());
    return 1;
  }
  return 0;
}
