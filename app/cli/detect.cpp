// binpick detect: finds trained parts in one frame.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>

#include "binpick/detect/detector.hpp"
#include "binpick/drivers/bop_dataset.hpp"
#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/detect_output.hpp"
#include "cli/notes.hpp"
#include "cli/number_between.hpp"
#include "error_text.hpp"
#include "frame_findings.hpp"
#include "replace_file.hpp"
#include "setup_error.hpp"
#include "sized_detector.hpp"
#include "thread_pool.hpp"

namespace binpick::app {
namespace {

struct DetectArguments {
  std::vector<std::string> models, meshes, bop_frame;
  std::string depth, intensity, camera, split = "test", sensor, roi;
  std::optional<double> depth_scale;
  std::string layout = "rearranged", isa = "best", modality = kModalityNames[0], json, overlay;
  std::string near_symmetry = kNearSymmetryNames[0];
  int threads = default_thread_count();
  int max_results = DetectRequest{}.max_results;
  double min_score = DetectRequest{}.min_score;
};

struct NamedFrame {
  drivers::LoadedFrame frame;
  std::string name;
};

NamedFrame load_frame(const DetectArguments& arguments) {
  if (!arguments.bop_frame.empty()) {
    const drivers::FrameId id = parse_frame_id("--bop-frame", arguments.bop_frame[1]);
    const drivers::BopDataset dataset(arguments.bop_frame[0], arguments.split, arguments.sensor);
    return {dataset.load_frame(dataset.scene(id.scene_id), id.im_id), drivers::frame_name(id)};
  }
  drivers::FrameCamera camera;  // a point cloud tells it
  if (!arguments.camera.empty()) {
    camera = drivers::load_camera_file(arguments.camera);
    print_notes(camera.notes);
  } else if (arguments.depth.empty() || !drivers::is_point_cloud_file(arguments.depth)) {
    throw CLI::RequiredError("detect: --camera, unless --depth is an organized point cloud,");
  }
  return {drivers::load_frame_files(arguments.depth, arguments.intensity, camera,
                                    arguments.depth_scale),
          arguments.depth.empty() ? arguments.intensity : arguments.depth};
}

// The CAD files that outlines are drawn from, each in the unit that its model was trained with.
std::vector<train::Mesh> load_meshes(const DetectArguments& arguments,
                                     std::span<const ModelFile> files) {
  std::vector<train::Mesh> meshes;
  for (std::size_t i = 0; i < arguments.meshes.size(); ++i) {
    const ModelInfo& info = files[i].model().info();
    train::ImportedMesh imported =
        train::import_mesh(arguments.meshes[i], train::unit_of_number(info.source_unit));
    if (imported.source_hash != info.source_hash) {
      std::fprintf(stderr, "binpick: warning: %s is not the CAD file that %s was trained from\n",
                   arguments.meshes[i].c_str(), files[i].path().c_str());
    }
    meshes.push_back(std::move(imported.mesh));
  }
  return meshes;
}

DetectorLimits limits_of(const Frame& frame, int max_results) {
  DetectorLimits limits;
  limits.image_width = frame.camera.width;
  limits.image_height = frame.camera.height;
  if (!frame.roi.whole_image()) {
    limits.roi_width = std::min(frame.roi.width, frame.camera.width);
    limits.roi_height = std::min(frame.roi.height, frame.camera.height);
  }
  limits.results_max = max_results;
  return limits;
}

int detect_parts(const DetectArguments& arguments) {
  DetectRun run;
  run.params.layout = arguments.layout == "plain" ? MapLayout::kPlain : MapLayout::kRearranged;
  run.params.isa = parse_isa("--isa", arguments.isa);
  run.request.modality = parse_modality("--modality", arguments.modality);
  run.request.near_symmetry = parse_near_symmetry("--near-symmetry", arguments.near_symmetry);
  run.request.max_results = arguments.max_results;
  run.request.min_score = arguments.min_score;
  run.threads = arguments.threads;
  if (!arguments.meshes.empty() && arguments.meshes.size() != arguments.models.size()) {
    throw CLI::ValidationError("--mesh", "expected one mesh for each model, in the same order");
  }
  const Roi roi = arguments.roi.empty() ? Roi{} : parse_roi("--roi", arguments.roi);

  if (!arguments.json.empty() && arguments.json != "-") check_replaceable(arguments.json);
  if (!arguments.overlay.empty()) check_replaceable(arguments.overlay);

  std::vector<ModelFile> files;
  std::vector<ObjectModel> models;
  for (const std::string& path : arguments.models) {
    files.emplace_back(path);
    models.push_back(files.back().model());
  }
  const std::vector<train::Mesh> meshes = load_meshes(arguments, files);
  const NamedFrame loaded = load_frame(arguments);
  print_notes(loaded.frame.notes);
  run.files = files;
  run.frame = loaded.frame.view();
  run.frame_name = loaded.name;
  if (!roi.whole_image()) run.frame.roi = roi;

  run.findings = check_frame(run.frame, {models, {}, run.request.modality});
  if (const Finding* refusal = run.findings.refusal()) {
    throw SetupError(run.frame_name + ": " +
                     finding_text(*refusal, [&](int model) { return run.part_name(model); }));
  }

  ThreadPool pool(arguments.threads);
  const DetectorLimits limits = limits_of(run.frame, arguments.max_results);
  SizedDetector sized(models, limits, run.params, pool);
  const Result<DetectionReport> report = sized.detector().detect(run.frame, run.request);
  if (!report.ok()) throw std::runtime_error(run.frame_name + ": " + error_text(report.error()));

  const std::string json = report_json(run, report.value());
  if (arguments.json == "-") {
    std::fputs(json.c_str(), stdout);
  } else {
    print_report(run, report.value());
    if (!arguments.json.empty()) {
      replace_file(arguments.json,
                   {reinterpret_cast<const std::uint8_t*>(json.data()), json.size()});
    }
  }
  if (!arguments.overlay.empty()) write_overlay(run, report.value(), meshes, arguments.overlay);
  return 0;
}

void add_frame_options(CLI::App& command, DetectArguments& arguments) {
  const char* const group = "Frame";
  auto* depth = command.add_option("--depth", arguments.depth,
                                   "Depth: 16-bit or float image (PNG, TIFF, OpenEXR, NumPy .npy), "
                                   "or organized point cloud (PLY, PCD)");
  auto* intensity = command.add_option("--intensity", arguments.intensity,
                                       "Gray or colour image of 8 to 16 bits [of a point cloud: "
                                       "its own]");
  auto* camera = command.add_option(
      "--camera", arguments.camera,
      "Camera file: JSON or YAML of binpick, BOP, OpenCV, ROS, RealSense or Open3D; FILE#NAME: one "
      "of several in it; with depth_scale [of a point cloud: fitted to it]");
  auto* depth_scale =
      command
          .add_option("--depth-scale", arguments.depth_scale,
                      "mm per unit of --depth [the camera file's depth_scale; of floats and points "
                      "mm or metres, where the values leave no doubt]")
          ->check(number_between(1e-6, 1e6));
  auto* bop = command
                  .add_option("--bop-frame", arguments.bop_frame,
                              "Instead: a data set in the BOP layout, and one of its frames")
                  ->type_name("DIR SCENE/IMAGE")
                  ->expected(2);
  auto* split = command.add_option("--split", arguments.split, "Split of the data set");
  auto* sensor = command.add_option("--sensor", arguments.sensor,
                                    "Of a data set with several sensors: the one to use");
  auto* roi =
      command.add_option("--roi", arguments.roi,
                         "Look only here: x,y,width,height in pixels; instead of the frame's own");
  depth->excludes(bop);
  depth_scale->needs(depth);
  intensity->excludes(bop);
  camera->excludes(bop);
  split->needs(bop)->capture_default_str();
  sensor->needs(bop);
  for (CLI::Option* option : {depth, intensity, camera, depth_scale, bop, split, sensor, roi})
    option->group(group);
}

}  // namespace

void add_detect_command(CLI::App& app, int& exit_status) {
  auto arguments = std::make_shared<DetectArguments>();
  CLI::App& command = *app.add_subcommand("detect", "Find trained parts in a frame");
  command.add_option("--model", arguments->models, "Model files, as train writes them")->required();
  add_frame_options(command, *arguments);
  command
      .add_option("--modality", arguments->modality,
                  "Images to look at: " + modality_list() + "; automatic: what the frame has")
      ->capture_default_str();
  command
      .add_option("--near-symmetry", arguments->near_symmetry,
                  "Poses that differ by a near symmetry are one: " + near_symmetry_list() +
                      "; auto: where detection cannot tell them, equivalent: always")
      ->capture_default_str();
  command.add_option("--max-results", arguments->max_results, "Parts to report at most")
      ->check(number_between(1, 10000))
      ->capture_default_str();
  command.add_option("--min-score", arguments->min_score, "Score that a part needs")
      ->check(number_between(0.0, 1.0))
      ->capture_default_str();
  command.add_option("--threads", arguments->threads, "Threads to use")
      ->check(number_between(1, 256))
      ->capture_default_str();
  command
      .add_option("--layout", arguments->layout, "Feature maps: rearranged, or plain to compare")
      ->check(CLI::IsMember({"rearranged", "plain"}))
      ->capture_default_str();
  command
      .add_option("--isa", arguments->isa,
                  "Vector instructions: best, scalar, sse4, avx2 or avx512")
      ->capture_default_str();
  command.add_option("--json", arguments->json,
                     "Write poses, times and counts to this file; - writes them to stdout");
  command.add_option("--overlay", arguments->overlay, "Draw the poses into this PNG");
  command.add_option(
      "--mesh", arguments->meshes,
      "CAD files to draw outlines from, one a model [the model's own contour points]");
  command.callback([arguments, &command, &exit_status] {
    const bool has_image = !arguments->depth.empty() || !arguments->intensity.empty();
    if (!has_image && arguments->bop_frame.empty()) {
      throw CLI::RequiredError(
          "detect: --depth, --intensity or both with --camera, or --bop-frame,");
    }
    exit_status = detect_parts(*arguments);
  });
}

}  // namespace binpick::app
