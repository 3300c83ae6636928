#include "memory_plan.hpp"

#include <linux/capability.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "daemon/metrics_sink.hpp"
#include "daemon/recorder_sink.hpp"
#include "daemon/result_board.hpp"
#include "metrics/metrics_server.hpp"
#include "setup_error.hpp"
#include "station/cycle.hpp"
#include "thread_pool.hpp"

namespace binpick::app {
namespace {

using Place = PlanLine::Place;

constexpr double kMiB = 1024 * 1024;
// Code, libraries and what they take at start, apart from the lines: with all else they stayed
// below the plan's sum (208 of 215 MiB resident with one recipe, locked).
constexpr std::size_t kProcessBytes = 64u << 20;
// Cycle, Modbus server, Modbus link, sensor session; one worker is the cycle's thread itself.
constexpr std::size_t kThreadsBesideWorkers = 4;

const char* place_name(Place place) {
  switch (place) {
    case Place::kArena:
      return "arena";
    case Place::kHeap:
      return "heap";
    case Place::kStack:
      return "stack";
  }
  return "";
}

void add_frames(const Config& config, MemoryPlan& plan) {
  const FramePoolParams params = frame_pool_params(config);
  const auto pixels =
      static_cast<std::size_t>(params.width_max) * static_cast<std::size_t>(params.height_max);
  const auto slots = static_cast<std::size_t>(params.slot_count);
  const std::size_t each =
      Arena::padded(pixels * sizeof(float)) + Arena::padded(pixels * sizeof(std::uint8_t));
  plan.lines.push_back({"frame pool", "frames: depth and intensity", slots, each});
  plan.lines.push_back(
      {"frame pool", "table of frames", 1, FramePool::footprint(params) - slots * each});
}

void add_operation(const Config& config, MemoryPlan& plan) {
  if (!config.recorder.folder.empty())
    plan.lines.push_back(
        {"recorder", "the last cycles, image buffers", 1, RecorderSink::footprint(config)});
  if (!config.metrics.listen.empty())
    plan.lines.push_back({"metrics", "answers to those who ask", 1,
                          MetricsServer::footprint(MetricsSink().registry())});
  plan.lines.push_back({"log", "lines to be written", 1, Log::footprint(), Place::kHeap});
}

std::string shown(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f MiB", bytes / kMiB);
  return text;
}

bool has_capability(int capability) {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct data[_LINUX_CAPABILITY_U32S_3]{};
  return syscall(SYS_capget, &header, data) == 0 &&
         (data[capability / 32].effective >> (capability % 32) & 1u) != 0;
}

// Empty: the system allows it to be locked. Without a limit for those who may lock what they want.
std::string lacks_locked_memory(const MemoryPlan& plan) {
  rlimit limit{};
  if (has_capability(CAP_IPC_LOCK) || getrlimit(RLIMIT_MEMLOCK, &limit) != 0) return "";
  const auto total = static_cast<double>(plan.bytes_total());
  if (limit.rlim_cur == RLIM_INFINITY || total <= static_cast<double>(limit.rlim_cur)) return "";
  return "memory.lock: the plan needs " + shown(total) + " of locked memory, the system allows " +
         shown(static_cast<double>(limit.rlim_cur)) + " (LimitMEMLOCK=, ulimit -l)";
}

// Threads of the parts that watch: log, and as configured recorder and metrics.
std::size_t operation_threads(const Config& config) {
  return 1 + !config.recorder.folder.empty() + !config.metrics.listen.empty();
}

}  // namespace

std::size_t MemoryPlan::arena_bytes() const {
  std::size_t sum = 0;
  for (const PlanLine& line : lines) sum += line.place == Place::kArena ? line.bytes() : 0;
  return sum;
}

std::size_t MemoryPlan::bytes_total() const {
  std::size_t sum = 0;
  for (const PlanLine& line : lines) sum += line.bytes();
  return sum;
}

std::string MemoryPlan::text() const {
  std::string table;
  char row[256];
  std::snprintf(row, sizeof row, "%-12s %-44s %-6s %6s %12s %10s\n", "owner", "what", "where",
                "count", "bytes each", "MiB");
  table += row;
  const auto mib = [](std::size_t bytes) { return static_cast<double>(bytes) / kMiB; };
  for (const PlanLine& line : lines) {
    std::snprintf(row, sizeof row, "%-12s %-44s %-6s %6zu %12zu %10.2f\n", line.owner.c_str(),
                  line.what.c_str(), place_name(line.place), line.count, line.bytes_each,
                  mib(line.bytes()));
    table += row;
  }
  std::snprintf(row, sizeof row, "%-84s %10.2f\n%-84s %10.2f\n", "arena", mib(arena_bytes()),
                "total", mib(bytes_total()));
  return table + row;
}

FramePoolParams frame_pool_params(const Config& config) {
  FramePoolParams params;
  params.slot_count = 1     // the driver fills it
                      + 1   // the sensor session hands it over
                      + 1   // the cycle computes in it, or keeps it for `process`
                      + 1;  // a burst
  params.width_max = config.sensor.width_max;
  params.height_max = config.sensor.height_max;
  return params;
}

int worker_count(const Config& config) {
  return config.threads.workers > 0 ? config.threads.workers : default_thread_count();
}

MemoryPlan make_memory_plan(const Config& config, const RecipeSet& recipes) {
  MemoryPlan plan;
  add_frames(config, plan);
  const int workers = worker_count(config);
  const int picks_max = config.station.picks_max;
  const std::size_t detector_bytes = Detector::footprint(
      recipes.models(), recipes.limits(), {MapLayout::kRearranged, config.threads.isa}, workers);
  plan.lines.push_back({"detector", "pyramids, maps, candidates, poses", 1, detector_bytes});
  plan.lines.push_back({"cycle", "picks and their order", 1, Cycle::footprint(picks_max)});
  plan.lines.push_back({"results", "last answers", 1, ResultBoard::footprint(picks_max)});
  add_operation(config, plan);
  for (const auto& file : recipes.files())
    plan.lines.push_back({"models", file->name(), 1, file->size_bytes(), Place::kHeap});
  // Payloads as large as a frame can be: four bytes of depth and one of intensity a pixel.
  const auto payload = static_cast<std::size_t>(config.sensor.width_max) *
                       static_cast<std::size_t>(config.sensor.height_max) * 5;
  const auto buffers = static_cast<std::size_t>(config.sensor.buffers);
  plan.lines.push_back({"sensor", "payload buffers, at most", buffers, payload, Place::kHeap});
  plan.lines.push_back(
      {"threads", "stacks",
       static_cast<std::size_t>(workers - 1) + kThreadsBesideWorkers + operation_threads(config),
       static_cast<std::size_t>(config.threads.stack_kib) << 10, Place::kStack});
  plan.lines.push_back({"process", "code, libraries, start", 1, kProcessBytes, Place::kHeap});
  return plan;
}

void check_memory_plan(const MemoryPlan& plan, const MemoryConfig& config) {
  const auto total = static_cast<double>(plan.bytes_total());
  if (total > config.mib_max * kMiB)
    throw SetupError("the plan needs " + shown(total) + ", memory.mib_max allows " +
                     std::to_string(config.mib_max) + " MiB (see binpickd --plan)");
  const std::string lacking = lacks_locked_memory(plan);
  if (config.lock && config.lock_required && !lacking.empty()) throw SetupError(lacking);
}

std::string lock_memory(const MemoryPlan& plan, const MemoryConfig& config) {
  if (!config.lock) return "";
  // Not tried where it would not last: with MCL_FUTURE what goes beyond the limit is not had at
  // all.
  std::string refused = lacks_locked_memory(plan);
  // A page is locked once it is touched: the arena's are from its start on, those of libraries and
  // stacks that nobody uses are not fetched for nothing.
  if (refused.empty() && mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0)
    refused = std::string("memory.lock: the pages cannot be locked: ") + std::strerror(errno) +
              " (LimitMEMLOCK=infinity or CAP_IPC_LOCK)";
  if (config.lock_required && !refused.empty()) throw SetupError(refused);
  return refused;
}

}  // namespace binpick::app
