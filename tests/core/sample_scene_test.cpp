// End to end on the sample data: parts trained from their CAD with a tenth of the samples, found in
// piles, judged by the truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "binpick/detect/detector.hpp"
#include "binpick/drivers/bop_truth.hpp"
#include "binpick/train/trainer.hpp"
#include "threads_per_call.hpp"

namespace binpick {
namespace {

constexpr double kAngleLimit_rad = 7.5 * M_PI / 180, kShiftLimit_mm = 5;

// Where the measured surfaces inside the region lie, but for one pixel in a hundred at either end.
std::pair<double, double> distance_range_mm(const Frame& frame) {
  std::vector<float> depths;
  for (int y = frame.roi.y; y < frame.roi.y + frame.roi.height; ++y) {
    for (int x = frame.roi.x; x < frame.roi.x + frame.roi.width; ++x) {
      if (frame.depth_mm.at(x, y) > 0) depths.push_back(frame.depth_mm.at(x, y));
    }
  }
  std::sort(depths.begin(), depths.end());
  return {static_cast<double>(depths[depths.size() / 100]),
          static_cast<double>(depths[depths.size() * 99 / 100])};
}

std::vector<std::uint8_t> trained(const std::string& mesh_path, const Frame& frame,
                                  WorkerPool& pool) {
  const auto [near_mm, far_mm] = distance_range_mm(frame);
  train::TrainOptions options;
  options.camera = frame.camera;
  options.distance_min_mm = near_mm;
  options.distance_max_mm = far_mm;
  options.samples = 100;
  options.gradient_threshold = 10;
  options.normal_threshold = 20;
  const auto part = train::import_mesh(mesh_path, train::LengthUnit::kMillimetre);
  return train::train_model(part, options, pool, {});
}

// Within the limits of an instance, under any of the part's symmetries.
bool matches(const Pose& found, const Pose& truth, const std::vector<Pose>& symmetries) {
  const auto near = [&](const Pose& T) {
    return (found.t_mm - T.t_mm).norm() < kShiftLimit_mm &&
           rotation_angle_between(found.R, T.R) < kAngleLimit_rad;
  };
  return near(truth) || std::any_of(symmetries.begin(), symmetries.end(),
                                    [&](const Pose& S) { return near(truth * S); });
}

struct Score {
  int wanted = 0;        // instances that are at least 70 % visible
  int found = 0;         // of those
  double precision = 0;  // at the score where F1 is best
};

Score score(std::span<const Detection> detections, const std::vector<drivers::TruthInstance>& truth,
            const std::vector<Pose>& symmetries) {
  Score out;
  std::vector<char> taken(truth.size(), 0);
  std::vector<char> wanted;
  for (const auto& t : truth) wanted.push_back(t.visible_fraction >= 0.7);
  out.wanted = static_cast<int>(std::count(wanted.begin(), wanted.end(), 1));
  int right = 0, used = 0;
  double best_f1 = -1;
  for (const Detection& d : detections) {  // best first
    ++used;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (taken[i] || !matches(d.T_cam_obj, truth[i].T_cam_obj, symmetries)) continue;
      taken[i] = 1;
      ++right;  // a part that is hardly visible was not asked for, but it is no mistake either
      out.found += wanted[i];
      break;
    }
    const double precision = static_cast<double>(right) / used;
    const double recall = static_cast<double>(out.found) / out.wanted;
    const double f1 = precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0;
    if (f1 >= best_f1) {
      best_f1 = f1;
      out.precision = precision;
    }
  }
  return out;
}

void expect_found(int scene_id, int obj_id) {
  const drivers::BopDataset data(BINPICK_TEST_DATA "/bin-sample", "test");
  const drivers::BopScene scene = data.scene(scene_id);
  const drivers::LoadedFrame loaded = data.load_frame(scene, 0);
  const drivers::BopModel part = data.models().at(obj_id);
  std::vector<drivers::TruthInstance> truth = drivers::load_truth(data, scene_id).at(0);
  std::erase_if(truth, [&](const auto& t) { return t.obj_id != obj_id; });

  ThreadsPerCall pool(2);
  const Frame frame = loaded.view();
  const std::vector<std::uint8_t> bytes = trained(part.mesh_path, frame, pool);
  const std::vector<ObjectModel> models = {ObjectModel::parse(bytes).value()};
  const DetectorLimits limits{frame.depth_mm.width, frame.depth_mm.height, 0, 0, 64};
  Arena arena(Detector::footprint(models, limits, {}, pool.thread_count()));
  Detector detector(models, limits, {}, pool, nullptr, arena);
  DetectRequest request;
  request.min_score = 0.2;
  const Result<DetectionReport> report = detector.detect(frame, request);
  ASSERT_TRUE(report.ok()) << error_message(report.error().code);

  const Score s = score(report.value().detections, truth, part.symmetries_discrete);
  std::printf("[ measured ] scene %d: %d of %d visible parts found, precision %.2f at best F1\n",
              scene_id, s.found, s.wanted, s.precision);
  ASSERT_GT(s.wanted, 3);
  EXPECT_GE(s.found, 0.7 * s.wanted);
  EXPECT_GE(s.precision, 0.8);
}

TEST(SampleScene, TeesAreFoundInAPile) {
  expect_found(1, 1);
}

TEST(SampleScene, HubsAreFoundInAPile) {
  expect_found(3, 3);
}

}  // namespace
}  // namespace binpick
