// Cycles for the recorder's tests: frames of any size with pixels that differ from cycle to cycle,
// and a recorder over them with an arena of its own.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "recorder/cycle_recorder.hpp"

namespace binpick::app {

struct TestFrame {
  TestFrame(int width, int height, std::uint64_t cycle, double scale_mm = 0.1);

  std::vector<float> depth_mm;
  std::vector<std::uint8_t> intensity;
  Frame frame;
};

// A record that borrows from this object.
struct TestCycle {
  explicit TestCycle(std::uint64_t cycle, const Frame* frame = nullptr, bool fault = false);

  std::vector<std::uint16_t> command, answer;
  std::vector<RecordedTime> times;
  CycleRecord record;
};

std::shared_ptr<const RecordedConfiguration> test_configuration(const std::string& text);

CycleRecorderParams test_params(const std::string& folder, RecordMode mode);

struct TestRecorder {
  explicit TestRecorder(const CycleRecorderParams& params);

  Arena arena;
  CycleRecorder recorder;
};

// Until the condition holds; false after a generous time.
bool holds_in_time(const std::function<bool()>& condition);

// The recordings in a folder, oldest first.
std::vector<std::string> recordings_in(const std::string& folder);
// The whole lines of a recording's cycles.jsonl.
std::vector<std::string> lines_of(const std::string& recording);

}  // namespace binpick::app
