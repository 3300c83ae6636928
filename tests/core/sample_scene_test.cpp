// End to end on the sample data: parts trained from their CAD with a twentieth of the samples,
// found in piles, judged by the truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "binpick/detect/detector.hpp"
#include "binpick/drivers/bop_truth.hpp"
#include "binpick/geometry/angle.hpp"
#include "binpick/train/trainer.hpp"
#include "threads_per_call.hpp"

namespace binpick {
namespace {

constexpr double kAngleLimit_rad = 7.5 * kDegree, kShiftLimit_mm = 5;

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
  options.samples = 50;
  options.gradient_threshold = 5;
  options.normal_threshold = 10;
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
  int picked = 0;        // of all, with the default score or more
  int picked_wrong = 0;
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
    bool is_right = false;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (taken[i] || !matches(d.T_cam_obj, truth[i].T_cam_obj, symmetries)) continue;
      taken[i] = 1;
      is_right = true;
      ++right;  // a part that is hardly visible was not asked for, but it is no mistake either
      out.found += wanted[i];
      break;
    }
    const bool picked = d.score >= DetectRequest{}.min_score;
    out.picked += picked;
    out.picked_wrong += picked && !is_right;
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

// Round gaps, until so much of what was measured in the region is lost.
std::vector<float> with_gaps(const Frame& frame, double share) {
  const ImageView<const float>& depth = frame.depth_mm;
  std::vector<float> out;
  for (int y = 0; y < depth.height; ++y)
    out.insert(out.end(), depth.row(y), depth.row(y) + depth.width);
  const Roi& roi = frame.roi;
  int left = 0;
  for (int y = roi.y; y < roi.y + roi.height; ++y) {
    for (int x = roi.x; x < roi.x + roi.width; ++x) left += depth.at(x, y) > 0;
  }
  left = static_cast<int>(left * share);
  std::mt19937 random(7);
  const auto below = [&](int end) {
    return static_cast<int>(random() % static_cast<unsigned>(end));
  };
  while (left > 0) {
    const int cx = roi.x + below(roi.width), cy = roi.y + below(roi.height), r = 3 + below(14);
    for (int y = std::max(roi.y, cy - r); y <= std::min(roi.y + roi.height - 1, cy + r); ++y) {
      for (int x = std::max(roi.x, cx - r); x <= std::min(roi.x + roi.width - 1, cx + r); ++x) {
        if ((x - cx) * (x - cx) + (y - cy) * (y - cy) > r * r) continue;
        float& z = out[static_cast<std::size_t>(y * depth.width + x)];
        left -= z > 0;
        z = 0;
      }
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
  const auto found_in = [&](const Frame& seen, const char* how) {
    const Result<DetectionReport> report = detector.detect(seen, request);
    EXPECT_TRUE(report.ok());
    const Score s = score(report.value().detections, truth, part.symmetries_discrete);
    std::printf(
        "[ measured ] scene %d%s: %d of %d visible parts found, precision %.2f at best F1; "
        "%d of %d wrong at the default score\n",
        scene_id, how, s.found, s.wanted, s.precision, s.picked_wrong, s.picked);
    return s;
  };
  const Score whole = found_in(frame, "");
  ASSERT_GT(whole.wanted, 3);
  EXPECT_GE(whole.found, 0.7 * whole.wanted);
  EXPECT_GE(whole.precision, 0.8);

  // Shiny: recall may fall, but not collapse, and precision holds.
  const std::vector<float> gaps = with_gaps(frame, 0.45);
  Frame shiny = frame;
  shiny.depth_mm = {gaps.data(), frame.depth_mm.width, frame.depth_mm.height, frame.depth_mm.width};
  const Score s = found_in(shiny, ", 45 % of the depth missing");
  EXPECT_GE(s.found, 0.6 * s.wanted);
  EXPECT_GE(s.precision, 0.75);
  EXPECT_GE(s.picked, 0.25 * whole.picked);
  EXPECT_LE(s.picked_wrong, whole.picked_wrong + 1);
}

TEST(SampleScene, TeesAreFoundInAPile) {
  expect_found(1, 1);
}

TEST(SampleScene, HubsAreFoundInAPile) {
  expect_found(3, 3);
}

}  // namespace
}  // namespace binpick
