// What a detector finds in a frame from the wire, from a recording and in the file itself: the
// same, bit for bit.
#include <gtest/gtest.h>

#include <bit>
#include <cstdio>

#include "../core/threads_per_call.hpp"
#include "binpick/detect/detector.hpp"
#include "binpick/train/trainer.hpp"
#include "gev_bench.hpp"

namespace binpick {
namespace {

// Quickly: few samples make a poor model, but a model.
std::vector<std::uint8_t> quick_model(const std::string& mesh_path, const Frame& frame,
                                      WorkerPool& pool) {
  train::TrainOptions options;
  options.camera = frame.camera;
  float near_mm = 1e9f, far_mm = 0;
  for (int y = frame.roi.y; y < frame.roi.y + frame.roi.height; ++y) {
    for (int x = frame.roi.x; x < frame.roi.x + frame.roi.width; ++x) {
      const float z = frame.depth_mm.at(x, y);
      if (z <= 0) continue;
      near_mm = std::min(near_mm, z);
      far_mm = std::max(far_mm, z);
    }
  }
  options.distance_min_mm = static_cast<double>(near_mm);
  options.distance_max_mm = static_cast<double>(far_mm);
  options.samples = 20;
  const auto part = train::import_mesh(mesh_path, train::LengthUnit::kMillimetre);
  return train::train_model(part, options, pool, {});
}

using Numbers = std::vector<std::uint64_t>;

// All of a detection's numbers, as bits.
void append_bits(const Detection& d, Numbers& bits) {
  const auto add = [&](double value) { bits.push_back(std::bit_cast<std::uint64_t>(value)); };
  for (int i = 0; i < 9; ++i) add(d.T_cam_obj.R(i / 3, i % 3));
  for (int i = 0; i < 3; ++i) add(d.T_cam_obj.t_mm(i));
  for (const double value : {d.score, d.visible_fraction, d.depth_support, d.contour_support,
                             d.depth_residual_mm, d.template_score})
    add(value);
  bits.push_back(static_cast<std::uint64_t>(d.model_index));
  bits.push_back(static_cast<std::uint64_t>(d.template_index));
}

TEST(GrabbedFrames, GiveTheDetectionsOfTheirFilesBitForBit) {
  drivers::GevBench b;
  b.spec.packet_size_bytes = 9000;
  const Frame file = b.files[0].view();
  ThreadsPerCall threads(2);
  const drivers::BopDataset data(kSampleBin, "test");
  const auto bytes = quick_model(data.models().at(1).mesh_path, file, threads);
  const std::vector<ObjectModel> models = {ObjectModel::parse(bytes).value()};
  const DetectorLimits limits{file.depth_mm.width, file.depth_mm.height, file.roi.width,
                              file.roi.height, 64};
  Arena arena(Detector::footprint(models, limits, {}, threads.thread_count()));
  Detector detector(models, limits, {}, threads, nullptr, arena);
  const auto detections_in = [&](Frame frame) {
    frame.roi = file.roi;  // a sensor knows none: it is the station's
    DetectRequest request;
    request.min_score = 0.2;
    Numbers bits;
    const Result<DetectionReport> report = detector.detect(frame, request);
    EXPECT_TRUE(report.ok());
    if (!report.ok()) return bits;
    for (const Detection& d : report.value().detections) append_bits(d, bits);
    return bits;
  };
  const Numbers wanted = detections_in(file);
  std::printf("[ measured ] %zu detections\n", wanted.size() / 20);
  ASSERT_GE(wanted.size(), 5u * 20);

  b.open();
  for (int i = 0; i < 2; ++i) {  // images 0 and 1 in turn
    const Result<FrameRef> grabbed = b.grab();
    ASSERT_TRUE(grabbed.ok());
    if ((grabbed.value().frame().sequence - 1) % 2 != 0) continue;
    EXPECT_EQ(detections_in(grabbed.value().frame()), wanted) << "from the wire";
  }
  b.camera.reset();
  drivers::CameraSpec recording;
  recording.uri = std::string("replay:") + kSampleBin;
  const auto replay = drivers::open_camera(recording);
  replay->start(b.pool);
  ASSERT_EQ(replay->trigger().code, ErrorCode::kNone);
  const Result<FrameRef> replayed =
      replay->wait_frame(std::chrono::steady_clock::now() + std::chrono::seconds(30));
  ASSERT_TRUE(replayed.ok());
  EXPECT_EQ(detections_in(replayed.value().frame()), wanted) << "from the recording";
}

}  // namespace
}  // namespace binpick
