// A simulated sensor that shows scene 1 of the sample bins (two images), a pool to grab into, and
// the files to compare with.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

#include "binpick/drivers/bop_dataset.hpp"
#include "binpick/drivers/open_camera.hpp"
#include "sample_bytes.hpp"
#include "simulator_process.hpp"

namespace binpick::drivers {

struct GevBench {
  using Clock = std::chrono::steady_clock;

  explicit GevBench(std::vector<std::string> extra = {}, int slots = 3)
      : address(loopback_address()),
        arena(FramePool::footprint({slots, 1280, 1024})),
        pool({slots, 1280, 1024}, arena) {
    arguments = {"--bind",  address, "--scenes", kSampleBin,
                 "--scene", "1",     "--serial", "T" + address};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    restart();
    spec.uri = "gev://" + address;
    spec.packet_socket = false;  // several sensors on one loopback interface
    const BopDataset data(kSampleBin, "test");
    scene = data.scene(1);
    for (int i = 0; i < 2; ++i) files.push_back(data.load_frame(scene, i));
  }
  void restart() {
    sim.reset();
    sim = std::make_unique<SimulatorProcess>(GVSIM, arguments);
  }
  void open() {
    camera = open_camera(spec);
    camera->start(pool);
  }
  Result<FrameRef> wait(std::chrono::milliseconds within = std::chrono::seconds(3)) {
    return camera->wait_frame(Clock::now() + within);
  }
  // Triggers until a frame is good; drops are counted by the camera.
  Result<FrameRef> grab(int attempts = 40) {
    Result<FrameRef> result = Error{ErrorCode::kSensorTimeout, 0, "never"};
    for (int i = 0; i < attempts && !result.ok(); ++i) {
      EXPECT_EQ(camera->trigger().code, ErrorCode::kNone);
      result = wait(std::chrono::milliseconds(600));
    }
    return result;
  }
  // Bit for bit the file that the frame's number stands for.
  bool equals_file(const Frame& frame) const {
    const LoadedFrame& file = files[(frame.sequence - 1) % files.size()];
    const std::size_t count = file.depth_mm.size();
    return frame.depth_mm.width == file.camera.width &&
           frame.depth_mm.height == file.camera.height &&
           std::memcmp(frame.depth_mm.data, file.depth_mm.data(), count * sizeof(float)) == 0 &&
           !frame.intensity.empty() &&
           std::memcmp(frame.intensity.data, file.intensity.data(), count) == 0;
  }

  std::string address;
  std::vector<std::string> arguments;
  std::unique_ptr<SimulatorProcess> sim;
  CameraSpec spec;
  BopScene scene;
  std::vector<LoadedFrame> files;
  Arena arena;
  FramePool pool;
  std::unique_ptr<Camera> camera;
};

}  // namespace binpick::drivers
