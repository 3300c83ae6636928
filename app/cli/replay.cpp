// binpick replay: runs the cycles of a recording again and compares the answers, register by
// register. Exit status 0: none differs.
#include <CLI/CLI.hpp>
#include <cinttypes>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "config/config_file.hpp"
#include "replay/station_replay.hpp"
#include "setup_error.hpp"
#include "station/cause.hpp"

namespace binpick::app {
namespace {

struct ReplayArguments {
  std::string recording, config, models;
  bool quiet = false;
};

struct ReplayCounts {
  int same = 0, differ = 0;
  std::vector<std::string> not_compared;  // which, and why
};

// "cycle 12", or "cycle 12, next_page" for what is none of its own.
std::string name_of(const RecordedCycle& cycle) {
  const std::string& order = cycle.order;
  const bool own = order.empty() || order == "detect" || order == "capture" || order == "process";
  return "cycle " + std::to_string(cycle.cycle) + (own ? "" : ", " + order);
}

// A model that is another file now is a reason for what differs.
void tell_other_models(const Recording& recording, const RecipeSet& recipes) {
  for (const Recording::Model& model : recording.models) {
    bool found = false;
    for (const auto& file : recipes.files()) found = found || file->checksum() == model.hash;
    if (!found)
      std::fprintf(stderr,
                   "binpick: warning: %s: is not among the models of this replay as it was\n",
                   model.path.c_str());
  }
}

void print_differences(const RecordedCycle& cycle,
                       const std::vector<RegisterDifference>& differences) {
  for (const RegisterDifference& d : differences)
    std::printf("%s: %s: 0x%04" PRIX32 " was recorded, 0x%04" PRIX32 " is replayed\n",
                name_of(cycle).c_str(), d.name, d.recorded, d.replayed);
}

int run(const ReplayArguments& arguments) {
  const Recording recording = load_recording(arguments.recording);
  const Config config = arguments.config.empty() ? recorded_config(recording, arguments.models)
                                                 : load_config(arguments.config);
  StationReplay replay(config, recording);
  tell_other_models(recording, replay.recipes());
  if (recording.cut_off)
    std::fprintf(stderr, "binpick: warning: the recording's last line is cut off\n");
  ReplayCounts counts;
  for (const RecordedCycle& cycle : recording.cycles) {
    const StationReplay::Answer answer = replay.run(cycle);
    if (answer.not_comparable != nullptr) {
      counts.not_compared.push_back(name_of(cycle) + ": " + answer.not_comparable);
      continue;
    }
    const std::vector<RegisterDifference> found = differences(cycle.answer, answer.registers);
    ++(found.empty() ? counts.same : counts.differ);
    if (!arguments.quiet) print_differences(cycle, found);
  }
  for (const std::string& text : counts.not_compared)
    std::printf("not comparable: %s\n", text.c_str());
  std::printf("%d answers the same, %d differ, %zu not comparable\n", counts.same, counts.differ,
              counts.not_compared.size());
  return counts.differ == 0 ? 0 : 1;
}

}  // namespace

void add_replay_command(CLI::App& app, int& exit_status) {
  const auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command =
      app.add_subcommand("replay", "Run recorded cycles again and compare the answers");
  command->add_option("recording", arguments->recording, "A recording's folder")->required();
  command->add_option("--config", arguments->config,
                      "Another configuration than the recording's own");
  command->add_option("--models", arguments->models,
                      "Where models are that are no longer where they were");
  command->add_flag("--quiet", arguments->quiet, "Not each register that differs");
  command->callback([arguments, &exit_status] { exit_status = run(*arguments); });
}

}  // namespace binpick::app
