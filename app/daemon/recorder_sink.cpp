#include "daemon/recorder_sink.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>

#include "config/config_writer.hpp"
#include "daemon/answer_of_result.hpp"

namespace fs = std::filesystem;

namespace binpick::app {
namespace {

CycleRecorderParams params_of(const Config& config) {
  CycleRecorderParams params;
  const auto bytes = [](int mib) { return static_cast<std::uint64_t>(mib) << 20; };
  params.shelf = {config.recorder.folder, bytes(config.recorder.mib_max),
                  bytes(config.recorder.free_mib_min)};
  params.mode = config.recorder.mode;
  params.ring = {config.recorder.cycles, config.sensor.width_max, config.sensor.height_max,
                 RecordRing::kSlotsMax};
  return params;
}

// As it is in effect, whatever the files say by now: recipes in the order in which the main file
// names them, under numbers, since their own names may lead anywhere.
std::shared_ptr<const RecordedConfiguration> configuration_of(const Config& config,
                                                              const RecipeSet& recipes) {
  auto recorded = std::make_shared<RecordedConfiguration>();
  recorded->program = "binpickd " BINPICK_VERSION;
  recorded->files.push_back({"binpick.toml", written_config(config)});
  for (std::size_t i = 0; i < config.recipes.size(); ++i) {
    const RecipeConfig& recipe = config.recipes[i];
    recorded->files.push_back(
        {"recipes/" + std::to_string(i + 1) + ".toml", written_recipe(recipe)});
    for (const std::string& path : recipe.models) {
      const auto is_it = [&](const auto& file) { return file->path() == path; };
      const auto file = std::find_if(recipes.files().begin(), recipes.files().end(), is_it);
      BINPICK_ASSERT(file != recipes.files().end());
      recorded->models.push_back(
          {static_cast<int>(i) + 1, fs::absolute(path).string(), (*file)->checksum()});
    }
  }
  return recorded;
}

bool is_cycle(OrderCode code) {
  return code == OrderCode::kDetect || code == OrderCode::kCapture || code == OrderCode::kProcess;
}

// Others turn pages, select, clear: the frame behind them was recorded before.
bool used_frame(const CycleResult& result) {
  return is_cycle(result.order.code) && !is_refusal(result.cause);
}

}  // namespace

std::size_t RecorderSink::footprint(const Config& config) {
  return CycleRecorder::footprint(params_of(config));
}

RecorderSink::RecorderSink(const Config& config, const RecipeSet& recipes, const ModbusLink* link,
                           Arena& arena)
    : encoding_(config.modbus.encoding),
      link_(link),
      recorder_(params_of(config), configuration_of(config, recipes), arena) {}

void RecorderSink::reload(const Config& config, const RecipeSet& recipes) {
  recorder_.set_mode(config.recorder.mode);
  recorder_.set_configuration(configuration_of(config, recipes));
}

void RecorderSink::on_result(const CycleResult& result, const StationStatus& status,
                             const FrameRef& kept_frame) {
  modbus::AnswerRegisters answer{};
  if (link_ != nullptr) {
    answer = link_->registers();
  } else {
    modbus::AnswerSnapshot snapshot;
    fill_answer(result, snapshot);
    modbus::encode_answer(snapshot, encoding_, answer);
  }
  const modbus::CommandRegisters command = command_registers(result.order, encoding_);
  const CycleTimes& t = result.times;
  constexpr int kTimes = 5;
  std::array<RecordedTime, kTimes + kStageCount> times = {{{"wait", t.wait_ms},
                                                           {"grab", t.grab_ms},
                                                           {"detect", t.detect_ms},
                                                           {"rank", t.rank_ms},
                                                           {"total", t.total_ms}}};
  static_assert(times.size() <= KeptRecord::kTimesMax);
  for (std::size_t i = 0; i < kStageCount; ++i)
    times[kTimes + i] = {stage_name(static_cast<Stage>(i)), result.stage_ms[i]};
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  CycleRecord record;
  record.cycle = result.cycle;
  record.unix_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
  record.cause = static_cast<int>(result.cause);
  record.cause_name = cause_name(result.cause);
  record.order_name = order_name(result.order.code);
  record.recipe_selected = status.recipe;
  record.fault = is_fault(result.cause);
  record.command = command;
  record.answer = answer;
  record.times = times;
  record.frame = kept_frame && used_frame(result) ? &kept_frame.frame() : nullptr;
  recorder_.record(record);
}

}  // namespace binpick::app
