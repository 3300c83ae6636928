#include "operation/recorded_frame.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <thread>

#include "binpick/drivers/depth_code.hpp"

namespace fs = std::filesystem;

namespace binpick::app {

TestFrame::TestFrame(int width, int height, std::uint64_t cycle, double scale_mm) {
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (std::size_t i = 0; i < count; ++i) {
    // Every seventh pixel is no measurement; the others are of any code.
    const auto code = static_cast<std::uint16_t>((i + cycle) * 40503u);
    depth_mm.push_back((i + cycle) % 7 == 0 ? 0 : drivers::depth_mm_from_code(code, scale_mm));
    intensity.push_back(static_cast<std::uint8_t>((i + cycle) * 2654435761u >> 24));
  }
  frame.depth_mm = {depth_mm.data(), width, height, width};
  frame.intensity = {intensity.data(), width, height, width};
  frame.depth_scale_mm = scale_mm;
  frame.camera = {width, height, 1000.1, 1000.7, width / 3.0, height / 3.0};
  frame.roi = {1, 2, width / 2, height / 2};
  frame.sequence = cycle;
}

TestCycle::TestCycle(std::uint64_t cycle, const Frame* frame, bool fault) {
  for (unsigned i = 0; i < 20; ++i) command.push_back(static_cast<std::uint16_t>(cycle + i));
  for (unsigned i = 0; i < 125; ++i) answer.push_back(static_cast<std::uint16_t>(65535 - i));
  times = {{"grab", 12.5}, {"detect", 100.25}};
  record.cycle = cycle;
  record.unix_ns = 1767225600'000'000'000 + static_cast<std::int64_t>(cycle) * 1'000'000;
  record.cause = fault ? 201 : 1;
  record.cause_name = fault ? "sensor_lost" : "done";
  record.fault = fault;
  record.command = command;
  record.answer = answer;
  record.times = times;
  record.frame = frame;
}

std::shared_ptr<const RecordedConfiguration> test_configuration(const std::string& text) {
  auto configuration = std::make_shared<RecordedConfiguration>();
  configuration->program = "test \"1\"";
  configuration->files = {{"binpick.toml", text}, {"recipes/part.toml", "number = 1\n"}};
  configuration->models = {{1, "/models/part.bpm", 0x0123456789abcdef}, {1, "b.bpm", 7}};
  return configuration;
}

CycleRecorderParams test_params(const std::string& folder, RecordMode mode) {
  CycleRecorderParams params;
  params.shelf = {folder + "/recordings", 1 << 30, 0};
  params.mode = mode;
  params.ring = {4, 96, 64};
  return params;
}

TestRecorder::TestRecorder(const CycleRecorderParams& params)
    : arena(CycleRecorder::footprint(params)),
      recorder(params, test_configuration("a = 1\n"), arena) {
  BINPICK_ASSERT(arena.used_bytes() == CycleRecorder::footprint(params));
  arena.seal();
}

bool holds_in_time(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

std::vector<std::string> recordings_in(const std::string& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(folder + "/recordings"))
    paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::vector<std::string> lines_of(const std::string& recording) {
  std::ifstream file(recording + "/cycles.jsonl");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line) && !file.eof();) lines.push_back(line);
  return lines;
}

}  // namespace binpick::app
