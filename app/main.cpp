// binpick: trains parts from CAD files, finds them in frames, measures how well, and talks to
// stations as their PLC does.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>

#include "binpick/train/errors.hpp"
#include "cli/commands.hpp"
#include "exit_status.hpp"
#include "standard_output.hpp"

namespace binpick::app {
namespace {

int report(ExitStatus status, std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::fflush(stdout);
  std::fprintf(stderr, "binpick: error: %s\n", message.c_str());
  return status;
}

int run(int argc, char** argv) {
  CLI::App app("Finds the poses of industrial parts in a bin, from their CAD files.", "binpick");
  app.set_version_flag("--version", "binpick " BINPICK_VERSION);
  app.set_help_all_flag("--help-all", "Print the help of every command");
  app.require_subcommand(1);
  int exit_status = 0;
  add_train_command(app, exit_status);
  add_detect_command(app, exit_status);
  add_info_command(app, exit_status);
  add_eval_command(app, exit_status);
  add_assess_command(app, exit_status);
  add_score_command(app, exit_status);
  add_trigger_command(app, exit_status);
  add_replay_command(app, exit_status);
  add_sensors_command(app, exit_status);
  add_sensor_info_command(app, exit_status);
  add_capture_command(app, exit_status);
  add_plc_command(app, exit_status);
  // CLI11 would only say that a command is missing.
  const auto is_first_word = [&](const CLI::App* command) {
    return command->get_name() == argv[1];
  };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_first_word).empty()) {
    return report(kUsage,
                  std::string("there is no command '") + argv[1] + "' (see binpick --help)");
  }
  try {
    app.parse(argc, argv);
    return exit_status;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // help or version was asked for
    return report(kUsage, std::string(e.what()) + " (see binpick --help)");
  }
}

}  // namespace
}  // namespace binpick::app

int main(int argc, char** argv) {
  using namespace binpick;
  // A limit on the size of files is then an error of the write, with a message, and not a signal.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    const int status = app::run(argc, argv);
    app::flush_standard_output();
    return status;
  } catch (const train::ImportError& e) {
    return app::report(app::kCannotStart, e.what());
  } catch (const train::TrainError& e) {
    return app::report(app::kCannotStart, e.what());
  } catch (const std::exception& e) {
    return app::report(app::status_of(e), app::text_of(e));
  }
}
