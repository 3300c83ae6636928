// binpick assess: what frames of one scene say about a cell, without truth.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "assess/assess_json.hpp"
#include "assess/assess_page.hpp"
#include "assess/assess_sections.hpp"
#include "binpick/drivers/bop_dataset.hpp"
#include "binpick/drivers/open_camera.hpp"
#include "cli/arguments.hpp"
#include "cli/commands.hpp"
#include "cli/id_list.hpp"
#include "cli/number_between.hpp"
#include "cli/progress.hpp"
#include "cli/sensor_arguments.hpp"
#include "error_text.hpp"
#include "model_file.hpp"
#include "replace_file.hpp"
#include "sensor/live_sensor.hpp"
#include "setup_error.hpp"
#include "thread_pool.hpp"

namespace binpick::app {
namespace {

constexpr int kSensorFrames = 20;
constexpr int kFramesHeld = 3;  // one that is searched, one being filled, the newest of a free run
constexpr int kPictureMargin_px = 40;
constexpr const char* kReplay = "replay:";

struct AssessArguments {
  std::vector<std::string> models;
  SensorArguments sensor;  // its URI is the source, or a folder
  std::string split = "test", scenes, roi, json, report;
  std::string modality = kModalityNames[0], near_symmetry = kNearSymmetryNames[0];
  int threads = default_thread_count(), count = 0;  // 0: all of a folder
  int max_results = DetectRequest{}.max_results;
  double timeout_s = 10;
  AssessSettings settings;
};

using VisitFrame = std::function<void(const Frame& frame, const std::string& name)>;

bool is_sensor(const std::string& source) {
  return drivers::is_live_sensor(source) || source.find("://") != std::string::npos;
}

void visit_folder(const AssessArguments& a, const std::string& folder, const VisitFrame& visit) {
  const drivers::BopDataset dataset(folder, a.split);
  const std::set<int> wanted = parse_id_list("--scenes", a.scenes);
  std::vector<drivers::BopScene> scenes;
  int frames = 0;
  for (const int id :
       wanted.empty() ? std::set(dataset.scene_ids().begin(), dataset.scene_ids().end()) : wanted) {
    scenes.push_back(dataset.scene(id));
    frames += static_cast<int>(scenes.back().frames.size());
  }
  if (a.count > 0) frames = std::min(frames, a.count);
  if (frames < kAssessFramesMin)
    throw SetupError(folder + ": " + std::to_string(frames) + (frames == 1 ? " frame" : " frames") +
                     " to look at: an assessment takes at least " +
                     std::to_string(kAssessFramesMin) + " of one scene, better " +
                     std::to_string(kAssessFramesGood) + " or more");
  Progress progress("assess");
  int done = 0;
  for (const drivers::BopScene& scene : scenes) {
    for (const auto& [im_id, camera] : scene.frames) {
      if (done == frames) return;
      const drivers::LoadedFrame loaded = dataset.load_frame(scene, im_id);
      visit(loaded.view(), drivers::frame_name({scene.scene_id, im_id}));
      progress.update(static_cast<double>(++done) / frames);
    }
  }
}

void visit_sensor(const AssessArguments& a, const VisitFrame& visit) {
  const drivers::CameraSpec spec = camera_spec_of(a.sensor);
  const FramePoolParams size{kFramesHeld, a.sensor.width_max, a.sensor.height_max};
  Arena arena(FramePool::footprint(size));
  FramePool pool(size, arena);
  try_sensor(spec, pool);
  LiveSensor sensor(spec, pool, {});
  const int frames = a.count > 0 ? a.count : kSensorFrames;
  Progress progress("assess");
  for (int i = 0; i < frames; ++i) {
    const Result<FrameRef> frame = grab_within(sensor.session(), a.timeout_s);
    if (!frame.ok()) throw std::runtime_error(spec.uri + ": " + error_text(frame.error()));
    visit(frame.value().frame(), "frame " + std::to_string(i + 1));
    progress.update(static_cast<double>(i + 1) / frames);
  }
}

void visit_source(const AssessArguments& a, const VisitFrame& visit) {
  const std::string& source = a.sensor.uri;
  if (is_sensor(source)) return visit_sensor(a, visit);
  const bool replay = source.starts_with(kReplay);
  visit_folder(a, replay ? source.substr(std::string(kReplay).size()) : source, visit);
}

void write_output(const std::string& path, const std::string& text) {
  replace_file(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::string list_text(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& text : texts) out += (out.empty() ? "" : ", ") + text;
  return out;
}

AssessPage page_of(const AssessArguments& a) {
  AssessPage page;
  page.title = "binpick assess " + a.sensor.uri;
  page.facts = {{"source", a.sensor.uri},
                {"models", list_text(a.models)},
                {"scene", a.settings.moved ? "moved between frames" : "stands still"},
                {"modality", a.modality},
                {"near symmetry", a.near_symmetry},
                {"threads", std::to_string(a.threads)}};
  if (!a.roi.empty()) page.facts.emplace_back("region", a.roi);
  return page;
}

int assess_source(AssessArguments& a) {
  DetectRequest request;
  request.modality = parse_modality("--modality", a.modality);
  request.near_symmetry = parse_near_symmetry("--near-symmetry", a.near_symmetry);
  request.max_results = a.max_results;
  request.min_score = 0;  // low scores are to be explained too
  a.settings.near_symmetry = request.near_symmetry;
  const Roi roi = a.roi.empty() ? Roi{} : parse_roi("--roi", a.roi);
  if (!a.json.empty()) check_replaceable(a.json);

  std::vector<ModelFile> files;
  std::vector<ObjectModel> models;
  std::vector<std::string> names;
  for (const std::string& path : a.models) {
    files.emplace_back(path);
    models.push_back(files.back().model());
    names.push_back(files.back().name());
  }
  ThreadPool pool(a.threads);
  FrameCollector collector(models, request, roi, pool);
  visit_source(a, [&](const Frame& frame, const std::string& name) { collector.add(frame, name); });
  Collection collection = collector.take();
  const CameraIntrinsics camera = collection.camera;
  const PixelRange region =
      collection.frames[static_cast<std::size_t>(collection.reference)].region;
  Picture picture = std::move(collection.picture);
  const Assessment assessment = assess(std::move(collection), models, names, a.settings);

  std::fputs(assessment_text(assessment).c_str(), stdout);
  if (!a.json.empty()) write_output(a.json, assessment_json(assessment).dump(2) + "\n");
  if (!a.report.empty()) {
    AssessPage page = page_of(a);
    picture = numbered_picture(std::move(picture), camera, assessment, models);
    const Roi shown{region.x0, region.y0, region.x1 - region.x0, region.y1 - region.y0};
    page.picture_png = encode_png(crop_to_roi(picture, shown, kPictureMargin_px));
    std::filesystem::create_directories(a.report);
    write_output((std::filesystem::path(a.report) / "assess.html").string(),
                 assessment_html(assessment, page));
  }
  return 0;
}

void add_search_options(CLI::App& command, AssessArguments& a) {
  command.add_option("--roi", a.roi,
                     "Look only here: x,y,width,height in pixels; instead of the frame's own");
  command
      .add_option("--modality", a.modality,
                  "Images to look at: " + modality_list() + "; automatic: what the frame has")
      ->capture_default_str();
  command
      .add_option("--near-symmetry", a.near_symmetry,
                  "Poses that differ by a near symmetry are one: " + near_symmetry_list() +
                      "; auto: where detection cannot tell them, equivalent: always")
      ->capture_default_str();
  command.add_option("--max-results", a.max_results, "Poses per frame, at most")
      ->check(number_between(1, 1024))
      ->capture_default_str();
  command.add_option("--threads", a.threads, "Threads to use")
      ->check(number_between(1, 256))
      ->capture_default_str();
}

// Those that `add` adds, as a group of the help.
std::vector<CLI::Option*> options_of(CLI::App& command, const char* group,
                                     const std::function<void()>& add) {
  const std::vector<CLI::Option*> before = command.get_options({});
  add();
  std::vector<CLI::Option*> added;
  for (CLI::Option* option : command.get_options({})) {
    if (std::ranges::find(before, option) == before.end()) added.push_back(option->group(group));
  }
  return added;
}

}  // namespace

void add_assess_command(CLI::App& app, int& exit_status) {
  auto a = std::make_shared<AssessArguments>();
  CLI::App& command = *app.add_subcommand(
      "assess", "Repeatability, score threshold and limits of a cell, from frames without truth");
  command
      .add_option("source", a->sensor.uri,
                  "Folder in BOP layout (a recording, what capture wrote), or a sensor: "
                  "gev://ADDRESS, gev://serial/N, u3v://serial/N, replay:DIR or sim:gev")
      ->required();
  command.add_option("--model", a->models, "Model file, as train writes it; once for each part")
      ->allow_extra_args(false)
      ->required();
  command.add_flag("--moved", a->settings.moved,
                   "The scene (or the sensor) was moved between frames, as a whole: the motion is "
                   "estimated from the poses and taken out");
  command
      .add_option(
          "--wrong-picks-max", a->settings.wrong_picks_max,
          "Share of wrong picks that the suggested threshold may be expected to let through")
      ->check(number_between(0.0001, 0.5))
      ->capture_default_str();
  command
      .add_option("--threshold", a->settings.threshold,
                  "Score that the station asks for: parts below it are explained")
      ->check(number_between(0.01, 0.99))
      ->capture_default_str();
  command.add_option("-n,--count", a->count, "Frames to look at [20 of a sensor, all of a folder]")
      ->check(number_between(1, 9999));
  add_search_options(command, *a);
  command.add_option("--json", a->json, "Write everything to this file as JSON");
  command.add_option("--report", a->report, "Folder for assess.html");
  const auto of_folders = options_of(command, "Folders", [&] {
    command.add_option("--split", a->split, "Split of the folder")->capture_default_str();
    command.add_option("--scenes", a->scenes, "Scenes of the folder, such as 1,2,5-7 [all]");
  });
  const auto of_sensors = options_of(command, "Sensors", [&] {
    command.add_option("--timeout-s", a->timeout_s, "How long to wait for a frame")
        ->check(number_between(0.1, 86400.0))
        ->capture_default_str();
    add_sensor_options(command, a->sensor);
    command.remove_option(command.get_option("--loop"));  // of recordings, which are folders here
  });
  command.callback([a, of_folders, of_sensors, &exit_status] {
    const bool sensor = is_sensor(a->sensor.uri);
    for (const CLI::Option* option : sensor ? of_folders : of_sensors) {
      if (option->count() > 0)
        throw CLI::ValidationError(option->get_name(),
                                   std::string("is for ") + (sensor ? "folders" : "sensors") +
                                       ", which '" + a->sensor.uri + "' is not");
    }
    exit_status = assess_source(*a);
  });
}

}  // namespace binpick::app
