// A simulated USB3 Vision sensor that shows scene 1 of the sample bins (two images), a pool to grab
// into, and the files to compare with. The test has to run under umockdev's library.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <memory>

#include "binpick/drivers/bop_dataset.hpp"
#include "binpick/drivers/open_camera.hpp"
#include "sample_bytes.hpp"
#include "simulator_process.hpp"

namespace binpick::drivers {

struct U3vBench {
  using Clock = std::chrono::steady_clock;

  explicit U3vBench(const std::vector<std::string>& extra = {},
                    const std::string& scenes = kSampleBin, int slots = 3)
      : arena(FramePool::footprint({slots, 1280, 1024})), pool({slots, 1280, 1024}, arena) {
    if (std::getenv("LD_PRELOAD") == nullptr)
      throw std::runtime_error("start this under umockdev-wrapper, as ctest does");
    std::vector<std::string> arguments = {"--scenes", scenes, "--scene",   "1",
                                          "--serial", "U1",   "--payload", "c16"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    sim = std::make_unique<SimulatorProcess>(U3VSIM, arguments);
    const std::string& line = sim->first_line();
    const std::size_t begin = line.find("UMOCKDEV_DIR=") + 13;
    folder = line.substr(begin, line.find(' ', begin) - begin);
    setenv("UMOCKDEV_DIR", folder.c_str(), 1);
    spec.uri = "u3v://serial/U1";
    const BopDataset data(scenes, "test");
    const BopScene scene = data.scene(1);
    for (int i = 0; i < 2; ++i) files.push_back(data.load_frame(scene, i));
  }
  void open() {
    camera = open_camera(spec);
    camera->start(pool);
  }
  void tell(const std::string& line) { ASSERT_EQ(sim->tell(line), "ok") << line; }
  // Bit for bit the depth of the file that the frame's number stands for.
  bool equals_file(const Frame& frame) const {
    const LoadedFrame& file = files[(frame.sequence - 1) % files.size()];
    return frame.depth_mm.width == file.camera.width &&
           frame.depth_mm.height == file.camera.height &&
           std::memcmp(frame.depth_mm.data, file.depth_mm.data(),
                       file.depth_mm.size() * sizeof(float)) == 0;
  }

  std::unique_ptr<SimulatorProcess> sim;
  std::string folder;  // umockdev's: its /dev and /sys
  CameraSpec spec;
  std::vector<LoadedFrame> files;
  Arena arena;
  FramePool pool;
  std::unique_ptr<Camera> camera;
};

}  // namespace binpick::drivers
