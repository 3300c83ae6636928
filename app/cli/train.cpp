// binpick train: a CAD file in, a model file out.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "binpick/drivers/loaded_frame.hpp"
#include "binpick/train/trainer.hpp"
#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/notes.hpp"
#include "cli/number_between.hpp"
#include "cli/progress.hpp"
#include "cli/self_test_text.hpp"
#include "cli/training_options.hpp"
#include "clock.hpp"
#include "replace_file.hpp"
#include "setup_error.hpp"
#include "thread_pool.hpp"

namespace binpick::app {
namespace {

struct TrainArguments {
  std::string mesh, output, camera, distance_mm, unit;
  train::SolidChoice solids;
  int threads = default_thread_count();
  train::TrainOptions options;
  TrialPlan trials;
};

// A sensor of one megapixel that sees a bin from half a metre to a metre: what is trained for when
// nothing better is known. Detection re-scales to the camera it meets.
constexpr CameraIntrinsics kTypicalCamera{1280, 1024, 1900, 1900, 639.5, 511.5};

CameraIntrinsics camera_of(const TrainArguments& arguments) {
  if (arguments.camera.empty()) {
    std::fprintf(stderr,
                 "binpick: warning: no --camera given: training for %dx%d pixels and a focal "
                 "length of %g px\n",
                 kTypicalCamera.width, kTypicalCamera.height, kTypicalCamera.fx);
    return kTypicalCamera;
  }
  const drivers::FrameCamera file = drivers::load_camera_file(arguments.camera);
  print_notes(file.notes);
  const CameraIntrinsics& camera = file.intrinsics;
  if (camera.width <= 0 || camera.height <= 0) {
    throw SetupError(arguments.camera + ": gives no width and height of the image");
  }
  return camera;
}

int train_part(TrainArguments arguments) {
  train::TrainOptions& options = arguments.options;
  const train::LengthUnit unit = parse_unit("--unit", arguments.unit);
  if (!arguments.distance_mm.empty()) {
    const auto [min_mm, max_mm] = parse_range("--distance-mm", arguments.distance_mm);
    options.distance_min_mm = min_mm;
    options.distance_max_mm = max_mm;
  }
  check_replaceable(arguments.output);
  const train::ImportedMesh part = train::import_mesh(arguments.mesh, unit, arguments.solids);
  for (const std::string& note : part.notes)
    std::fprintf(stderr, "binpick: warning: %s\n", note.c_str());
  options.camera = camera_of(arguments);

  ThreadPool pool(arguments.threads);
  const std::int64_t begin_ns = monotonic_ns();
  StepProgress progress;
  const TrainedPart trained =
      train_part(part, options, arguments.trials, pool,
                 [&](const std::string& step, double share) { progress.update(step, share); });
  progress.finish();
  replace_file(arguments.output, trained.model);
  std::printf("%s: %zu triangles, trained in %.1f s on %d threads, %.1f MB\n",
              arguments.output.c_str(), part.mesh.triangles.size(),
              static_cast<double>(monotonic_ns() - begin_ns) * 1e-9, arguments.threads,
              static_cast<double>(trained.model.size()) * 1e-6);
  if (trained.self_test) print_self_test(*trained.self_test, trained.advice);
  return 0;
}

}  // namespace

void add_train_command(CLI::App& app, int& exit_status) {
  auto arguments = std::make_shared<TrainArguments>();
  CLI::App& command = *app.add_subcommand("train", "Learn a part from its CAD file");
  train::TrainOptions& options = arguments->options;
  command
      .add_option(
          "MESH", arguments->mesh,
          "CAD file: STEP, IGES, STL, PLY, OBJ, 3MF, COLLADA, FBX, glTF, ...; its coordinates "
          "are taken in mm with z up, as in the CAD program, whatever the format")
      ->required();
  command.add_option("-o,--output", arguments->output, "Model file to write")->required();
  command.add_option("--camera", arguments->camera,
                     "Camera file, as of detect, with width and height");
  command.add_option("--distance-mm", arguments->distance_mm,
                     "Camera to the part's origin, MIN:MAX [500:700]");
  command
      .add_option("--tilt-deg", options.tilt_max_deg,
                  "Viewpoints within this angle of the part's +z axis; 180: all around")
      ->check(number_between(0.0, 180.0))
      ->capture_default_str();
  command.add_option("--unit", arguments->unit,
                     "Unit of the CAD file: mm, cm, m, inch, ft or um [what the file says; guessed "
                     "where its format has no unit: STL, PLY, OBJ]");
  command.add_option("--body", arguments->solids.body,
                     "STEP and IGES: name or number of the body that is the part, or all; needed "
                     "where the file has several");
  command
      .add_option("--deflection-mm", arguments->solids.deflection_mm,
                  "STEP and IGES: distance of triangles from the surface, at most [0.05, or 1/2000 "
                  "of the diameter where that is more]")
      ->check(number_between(0.0001, 100.0));
  command.add_option("--threads", arguments->threads, "Threads to use")
      ->check(number_between(1, 256))
      ->capture_default_str();
  command.add_option("--seed", options.seed, "Seed of the random samples")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  add_template_options(command, options);
  add_trial_options(command, arguments->trials, true);
  command.callback([arguments, &exit_status] { exit_status = train_part(*arguments); });
}

}  // namespace binpick::app
