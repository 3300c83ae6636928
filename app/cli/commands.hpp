// The sub-commands of binpick. Each adds its options to the app; its callback runs the command and
// leaves the exit status: 0 done, 1 done with faults that were named on the way. What stops a
// command before it has done anything is an exception with one sentence, for main to print.
#pragma once

namespace CLI {
class App;
}

namespace binpick::app {

void add_train_command(CLI::App& app, int& exit_status);
void add_info_command(CLI::App& app, int& exit_status);
void add_detect_command(CLI::App& app, int& exit_status);
void add_eval_command(CLI::App& app, int& exit_status);
void add_assess_command(CLI::App& app, int& exit_status);
void add_score_command(CLI::App& app, int& exit_status);
void add_replay_command(CLI::App& app, int& exit_status);
void add_trigger_command(CLI::App& app, int& exit_status);
void add_sensors_command(CLI::App& app, int& exit_status);
void add_sensor_info_command(CLI::App& app, int& exit_status);
void add_capture_command(CLI::App& app, int& exit_status);
void add_plc_command(CLI::App& app, int& exit_status);

}  // namespace binpick::app
