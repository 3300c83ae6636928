// Times the whole detector on the data sets below a folder; what is compared takes turns on the
// same frames. Writes one JSON: for each experiment and setting the times of all searches, in ms.
//   system_bench DATA MODEL-CACHE ROUNDS OUT.json
// DATA/parts holds scenes of one part each and a mixed one, which comes last; DATA/resolution/* and
// DATA/instances/* hold the same parts, seen by other cameras and in other numbers.
#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <tuple>

#include "binpick/drivers/bop_truth.hpp"
#include "eval/eval_plan.hpp"
#include "eval/model_set.hpp"
#include "sized_detector.hpp"
#include "thread_pool.hpp"

namespace binpick::app {
namespace {

namespace fs = std::filesystem;

struct BenchFrame {
  drivers::LoadedFrame loaded;
  std::vector<int> models;  // of the parts in it
  std::size_t part_count = 0;

  double megapixels() const { return loaded.camera.width * loaded.camera.height * 1e-6; }
};

// One way to search a frame.
struct Setting {
  std::string name;
  int threads = 1;
  MapLayout layout = MapLayout::kRearranged;
  double region_scale = 1;  // of the sides of the frame's region; 0: the whole image
  std::size_t models_max = 1;
};

Roi scaled_region(const drivers::LoadedFrame& frame, double scale) {
  if (scale == 0) return {};
  Roi roi = frame.roi;
  roi.width = static_cast<int>(roi.width * scale);
  roi.height = static_cast<int>(roi.height * scale);
  roi.x += (frame.roi.width - roi.width) / 2;
  roi.y += (frame.roi.height - roi.height) / 2;
  return roi;
}

class Bench {
 public:
  Bench(const fs::path& data, const std::string& model_folder, int rounds)
      : data_(data), rounds_(rounds), dataset_((data / "parts").string(), "test") {
    const EvalPlan plan = make_eval_plan(dataset_, {});
    const PartLibrary parts = load_parts(dataset_, plan.objects());
    ThreadPool pool(default_thread_count());
    const ModelCache cache(model_folder);
    models_ = make_model_set({dataset_, plan, plan.cameras.at(0), parts, cache, {}, kNoTrials},
                             pool, {}, faults_);
  }

  void run_all() {
    std::vector<BenchFrame> alone = frames_of(data_ / "parts"), mixed;
    for (; alone.back().models.size() > 1; alone.pop_back()) mixed.push_back(alone.back());
    run("stages", alone, {{"1 thread", 1}, {"2 threads", 2}});
    run("layout", alone, {{"rearranged", 1}, {"plain", 1, MapLayout::kPlain}});
    const auto region = [](const char* name, double scale) {
      return Setting{name, 2, MapLayout::kRearranged, scale};
    };
    run("region", alone,
        {region("quarter of the bin", 0.5), region("half of the bin", 0.7071), region("the bin", 1),
         region("whole image", 0)});
    std::vector<Setting> counts;
    for (std::size_t n = 1; n <= models_.models().size(); n *= 2)
      counts.push_back({std::to_string(n), 2, MapLayout::kRearranged, 1, n});
    run("models", mixed, counts);
    run_over_folders("resolution", [](const BenchFrame& f) { return f.megapixels(); });
    run_over_folders("instances", [](const BenchFrame& f) { return f.part_count; });
  }

  const nlohmann::ordered_json& results() const { return results_; }
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  using Detectors = std::map<std::tuple<int, MapLayout, bool>, std::unique_ptr<SizedDetector>>;

  std::vector<BenchFrame> frames_of(const fs::path& folder) const {
    const drivers::BopDataset dataset(folder.string(), "test");
    std::vector<BenchFrame> frames;
    for (const int scene_id : dataset.scene_ids()) {
      const drivers::BopScene scene = dataset.scene(scene_id);
      const TruthByFrame truth = load_score_truth(dataset, scene);
      for (const auto& [im_id, camera] : scene.frames) {
        const std::vector<ScoredInstance>& instances = truth.at({scene_id, im_id});
        std::set<int> objects;
        for (const ScoredInstance& instance : instances) objects.insert(instance.truth.obj_id);
        BenchFrame frame{dataset.load_frame(scene, im_id), {}, instances.size()};
        for (const int id : objects) frame.models.push_back(models_.index_of(id));
        frames.push_back(std::move(frame));
      }
    }
    return frames;
  }

  // Each folder's frames as one setting, named by a number of theirs.
  template <class Name>
  void run_over_folders(const std::string& experiment, Name&& name) {
    std::cerr << experiment << std::endl;
    std::vector<std::vector<BenchFrame>> sets;
    for (const auto& entry : fs::directory_iterator(data_ / experiment))
      sets.push_back(frames_of(entry.path()));
    std::vector<Detectors> detectors(sets.size());
    for (int round = 0; round <= rounds_; ++round) {
      for (std::size_t i = 0; i < sets.size(); ++i) {
        const Setting setting{std::to_string(name(sets[i].front())), 2};
        for (const BenchFrame& frame : sets[i])
          search(experiment, frame, setting, sets[i], detectors[i], round);
      }
    }
  }

  void run(const std::string& experiment, const std::vector<BenchFrame>& frames,
           const std::vector<Setting>& settings) {
    std::cerr << experiment << std::endl;
    Detectors detectors;
    for (int round = 0; round <= rounds_; ++round) {
      for (const BenchFrame& frame : frames) {
        for (const Setting& setting : settings)
          search(experiment, frame, setting, frames, detectors, round);
      }
    }
  }

  void search(const std::string& experiment, const BenchFrame& frame, const Setting& setting,
              const std::vector<BenchFrame>& frames, Detectors& detectors, int round) {
    Frame view = frame.loaded.view();
    view.roi = scaled_region(frame.loaded, setting.region_scale);
    DetectRequest request;
    // Parts differ in what they cost: each round begins with another one.
    std::vector<int> models = frame.models;
    std::rotate(models.begin(), models.begin() + round % std::ssize(models), models.end());
    models.resize(std::min(setting.models_max, models.size()));
    request.model_indices = models;
    auto& sized = detectors[{setting.threads, setting.layout, setting.region_scale == 0}];
    if (!sized) sized = make_detector(setting, frames);
    const Result<DetectionReport> result = sized->detector().detect(view, request);
    if (!result.ok()) throw std::runtime_error(experiment + ": a frame cannot be searched");
    if (round == 0) return;  // it warms up
    const DetectionReport& report = result.value();
    const ObjectModel& model = models_.models()[static_cast<std::size_t>(frame.models.front())];
    results_[experiment][setting.name].push_back({{"total", report.total_ms},
                                                  {"stages", report.stage_ms},
                                                  {"levels", report.level_ms},
                                                  {"scan_depth", model.info().scan_depth},
                                                  {"found", report.detections.size()}});
  }

  std::unique_ptr<SizedDetector> make_detector(const Setting& setting,
                                               const std::vector<BenchFrame>& frames) {
    DetectorLimits limits;
    limits.image_width = frames.front().loaded.camera.width;
    limits.image_height = frames.front().loaded.camera.height;
    if (setting.region_scale > 0) {
      for (const BenchFrame& frame : frames) {
        limits.roi_width = std::max(limits.roi_width, frame.loaded.roi.width);
        limits.roi_height = std::max(limits.roi_height, frame.loaded.roi.height);
      }
    }
    auto& pool = pools_[setting.threads];
    if (!pool) pool = std::make_unique<ThreadPool>(setting.threads);
    DetectorParams params;
    params.layout = setting.layout;
    return std::make_unique<SizedDetector>(models_.models(), limits, params, *pool);
  }

  const fs::path data_;
  const int rounds_;
  const drivers::BopDataset dataset_;
  ModelSet models_;
  std::map<int, std::unique_ptr<ThreadPool>> pools_;
  std::vector<std::string> faults_;
  nlohmann::ordered_json results_;  // settings stay in their order
};

void run(char** argv) {
  Bench bench(argv[1], argv[2], std::atoi(argv[3]));
  for (const std::string& fault : bench.faults()) throw std::runtime_error(fault);
  bench.run_all();
  nlohmann::ordered_json out = bench.results();
  for (int s = 0; s < kStageCount; ++s) out["stage_names"].push_back(stage_name(Stage{s}));
  std::ofstream(argv[4]) << out.dump();
}

}  // namespace
}  // namespace binpick::app

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: system_bench DATA MODEL-CACHE ROUNDS OUT.json\n";
    return 2;
  }
  try {
    binpick::app::run(argv);
  } catch (const std::exception& e) {
    std::cerr << "system_bench: " << e.what() << '\n';
    return 1;
  }
}
