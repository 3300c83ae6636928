// binpickd: the station's daemon.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "binpick/drivers/open_camera.hpp"
#include "config/config_file.hpp"
#include "config/pose_check.hpp"
#include "daemon/daemon.hpp"
#include "daemon/thread_setup.hpp"
#include "exit_status.hpp"
#include "sensor/sensor_spec.hpp"
#include "standard_output.hpp"

namespace binpick::app {
namespace {

struct Arguments {
  std::string config = "/etc/binpick/binpick.toml";
  bool check = false, plan = false;
};

// A line a fault.
int report(ExitStatus status, const std::string& message) {
  std::fflush(stdout);
  for (std::size_t begin = 0; begin <= message.size();) {
    const std::size_t end = std::min(message.find('\n', begin), message.size());
    std::fprintf(stderr, "binpickd: error: %s\n", message.substr(begin, end - begin).c_str());
    begin = end + 1;
  }
  return status;
}

void warn(const Config& config) {
  for (const ConfigFault& warning : pose_warnings(config))
    std::fprintf(stderr, "binpickd: warning: %s\n", warning.text().c_str());
}

// What does not start a sensor: files, models and the memory plan.
int look_only(const Arguments& arguments, const Config& config) {
  warn(config);
  camera_spec_of(config.sensor);  // for its faults
  check_frame_sizes(config);
  const RecipeSet recipes(config);
  const MemoryPlan plan = make_memory_plan(config, recipes);
  if (arguments.plan) std::fputs(plan.text().c_str(), stdout);
  check_memory_plan(plan, config.memory);
  if (arguments.check) std::printf("%s: can be used\n", arguments.config.c_str());
  return kDone;
}

int serve(const Config& config) {
  SignalInbox::block();
  set_up_threads_and_heap(config.threads);
  LogParams log_params;
  log_params.level = config.logging.level;
  Log log(log_params);
  Notifier notifier;
  const drivers::CameraSpec spec = camera_spec_of(config.sensor);
  check_frame_sizes(config);
  Daemon daemon(
      config, [spec] { return drivers::open_camera(spec); }, log, notifier);
  daemon.run();
  return kDone;
}

int run(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Serves picks to a PLC: triggers, grabs, detects, ranks, publishes.", "binpickd");
  app.set_version_flag("--version", "binpickd " BINPICK_VERSION);
  app.add_option("--config", arguments.config, "The configuration file")->capture_default_str();
  app.add_flag("--check", arguments.check, "Only check the configuration and the models");
  app.add_flag("--plan", arguments.plan, "Only print the memory that would be taken");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    return report(kUsage, std::string(e.what()) + " (see binpickd --help)");
  }
  const Config config = load_config(arguments.config);
  if (arguments.check || arguments.plan) return look_only(arguments, config);
  return serve(config);
}

}  // namespace
}  // namespace binpick::app

int main(int argc, char** argv) {
  using namespace binpick;
  try {
    const int status = app::run(argc, argv);
    app::flush_standard_output();
    return status;
  } catch (const std::exception& e) {
    return app::report(app::status_of(e), app::text_of(e));
  }
}
