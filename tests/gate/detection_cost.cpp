// What detection costs beside a reference kernel, for each scene of a data set: CPU time of one
// thread over that of the kernel, the two taking turns. Other work on the machine slows both.
//   detection_cost DATASET MODEL-CACHE    prints a line each: scene, ratio, ms of detection
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <exception>
#include <map>
#include <vector>

#include "eval/frame_search.hpp"
#include "gate/reference_kernel.hpp"
#include "thread_pool.hpp"

namespace binpick::app {
namespace {

constexpr int kTurns = 5;

double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct SceneCost {
  std::vector<double> ratios, detect_ms;
};

class Bench {
 public:
  // Detection is compared with the mean of the kernel's runs before and after it.
  Result<int> measure(const FrameVisit& visit) {
    SceneCost& cost = scenes_[visit.wanted.id.scene_id];
    double before_ms = kernel_ms();
    for (int turn = -1; turn < kTurns; ++turn) {  // the first one warms up
      const double begin_ms = thread_ms();
      const Result<DetectionReport> report =
          visit.detector.detect(visit.frame.view(), visit.request);
      const double detect_ms = thread_ms() - begin_ms;
      if (!report.ok()) return report.error();
      const double after_ms = kernel_ms();
      if (turn >= 0) {
        cost.ratios.push_back(2 * detect_ms / (before_ms + after_ms));
        cost.detect_ms.push_back(detect_ms);
      }
      before_ms = after_ms;
    }
    return 0;
  }

  void print() const {
    for (const auto& [scene, cost] : scenes_)
      std::printf("%d %.4f %.2f\n", scene, median(cost.ratios), median(cost.detect_ms));
  }

 private:
  double kernel_ms() {
    const double begin_ms = thread_ms();
    sink_ = kernel_.run();
    return thread_ms() - begin_ms;
  }

  ReferenceKernel kernel_;
  volatile double sink_ = 0;
  std::map<int, SceneCost> scenes_;
};

int run(const char* folder, const char* model_folder) {
  const drivers::BopDataset dataset(folder, "test");
  const EvalPlan plan = make_eval_plan(dataset, {});
  const PartLibrary parts = load_parts(dataset, plan.objects());
  const ModelCache cache(model_folder);
  ThreadPool pool(1);
  SearchSettings settings;
  // The vector unit that most machines have, so that the ratio does not depend on the machine's.
  settings.params.isa = Isa::kAvx2;
  std::vector<std::string> faults = plan.faults;
  Bench bench;
  for (const CameraGroup& group : plan.cameras) {
    const ModelSet models = make_model_set(
        {dataset, plan, group, parts, cache, {}, {.test_piles = 0}}, pool, {}, faults);
    visit_frames(dataset, plan, group, models, settings, pool, {}, "", faults,
                 [&](const FrameVisit& visit) { return bench.measure(visit); });
  }
  bench.print();
  for (const std::string& fault : faults) std::fprintf(stderr, "%s\n", fault.c_str());
  return faults.empty() ? 0 : 1;
}

}  // namespace
}  // namespace binpick::app

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: detection_cost DATASET MODEL-CACHE\n");
    return 2;
  }
  if (!binpick::isa_supported(binpick::Isa::kAvx2)) {
    std::fprintf(stderr, "skipped: this machine has no AVX2\n");
    return 77;
  }
  try {
    return binpick::app::run(argv[1], argv[2]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "detection_cost: %s\n", e.what());
    return 1;
  }
}
