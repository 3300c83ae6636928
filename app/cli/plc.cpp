// binpick plc: a PLC's side of the handshake, to commission a station and to test it.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>

#include "binpick/geometry/angle.hpp"
#include "cli/commands.hpp"
#include "cli/number_between.hpp"
#include "clock.hpp"
#include "modbus/rotation.hpp"
#include "plc/answer_text.hpp"
#include "plc/plc_session.hpp"
#include "plc/soak.hpp"
#include "setup_error.hpp"
#include "standard_output.hpp"

namespace binpick::app {
namespace {

namespace map = modbus::map;

struct PlcArguments {
  plc::Target target;
  plc::SoakOptions soak;
  std::string command = "detect";
  std::vector<double> flange;
  bool watch = false;
  bool no_heartbeat = false;
  double seconds = 0;
};

double ms_since(std::int64_t then_ns, std::int64_t now_ns) {
  return static_cast<double>(now_ns - then_ns) * 1e-6;
}

void pause_ms(int ms) {
  std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

int print_faults(const plc::PlcSession& session) {
  for (const std::string& fault : session.invariants().faults()) {
    std::printf("broken: %s\n", fault.c_str());
  }
  return session.invariants().fault_count() == 0 ? 0 : 1;
}

void print_written(const modbus::CommandRegisters& block) {
  const auto show = [&](int address, const char* name) {
    std::printf("  %-12s %-24s %d\n", plc::address_text(address).c_str(), name,
                block[static_cast<std::size_t>(address - map::kCommandStart)]);
  };
  show(map::kAddressPlcHeartbeat, "plc_heartbeat");
  show(map::kAddressCommandCode, "command_code");
  show(map::kAddressCommandRecipe, "command_recipe");
  show(map::kAddressCommandPicksMax, "command_picks_max");
  show(map::kAddressCommandDeadline, "command_deadline");
  show(map::kAddressCommandPage, "command_page");
  show(map::kAddressCommandSequence, "command_sequence");
}

// One command, each step with its registers.
int hand_shake(plc::PlcSession& session, const PlcArguments& arguments) {
  std::printf("1. read %s to %d: one whole answer\n", plc::address_text(map::kAnswerStart).c_str(),
              map::kAnswerStart + map::kAnswerCount - 1);
  plc::print_conventions(session.first().decoded);
  plc::print_answer(session.first().decoded);
  const int sequence = session.send(arguments.soak.command);
  std::printf("2. wrote command %s in one write, command_sequence last\n",
              arguments.command.c_str());
  print_written(session.sent());
  bool acknowledged = false;
  const auto seen = session.wait_for_answer(
      arguments.soak.timeout_ms, [&] { pause_ms(arguments.soak.poll_ms); },
      [&](const plc::PlcSession::Seen& read) {
        if (acknowledged || read.decoded.answer.acknowledged_sequence != sequence) return;
        acknowledged = true;
        std::printf("3. acknowledged_sequence is %d, seen after %.1f ms\n", sequence,
                    ms_since(session.sent_ns(), read.ended_ns));
      });
  if (!seen) {
    std::printf("%s: no answer within %d ms\n",
                acknowledged ? "4. acknowledged, but" : "3. not acknowledged, and",
                arguments.soak.timeout_ms);
    print_faults(session);
    return 1;
  }
  const modbus::AnswerSnapshot& answer = seen->decoded.answer;
  std::printf("4. result_command is %d, seen after %.1f ms (cycle_time %lld ms)\n", sequence,
              ms_since(session.sent_ns(), seen->ended_ns),
              static_cast<long long>(answer.cycle_time_ms));
  plc::print_answer(seen->decoded);
  plc::print_picks(seen->decoded, seen->registers);
  const bool done = static_cast<int>(answer.cause) < 100;
  return print_faults(session) != 0 || !done ? 1 : 0;
}

// A line for each change, without writing anything.
int watch(plc::PlcSession& session, const PlcArguments& arguments) {
  const std::int64_t begin_ns = monotonic_ns();
  modbus::AnswerSnapshot last;
  for (bool first = true;
       arguments.seconds <= 0 || ms_since(begin_ns, monotonic_ns()) < arguments.seconds * 1000;
       first = false) {
    if (const auto seen = session.read()) {
      const modbus::AnswerSnapshot& a = seen->decoded.answer;
      if (first || a.state != last.state || a.result_sequence != last.result_sequence ||
          a.acknowledged_sequence != last.acknowledged_sequence) {
        std::printf("%10.3f s  acknowledged %5d  result %5d of command %5d  %s, %d picks  [%s]\n",
                    ms_since(begin_ns, seen->ended_ns) * 1e-3, a.acknowledged_sequence,
                    a.result_sequence, a.result_command, plc::name_of(a.cause).c_str(), a.picks,
                    plc::state_text(a.state).c_str());
      }
      if (a.result_sequence != last.result_sequence && a.page_pick_count > 0) {
        plc::print_picks(seen->decoded, seen->registers);
      }
      flush_standard_output();
      last = a;
    }
    pause_ms(arguments.soak.poll_ms);
  }
  return print_faults(session);
}

int run_soak(plc::PlcSession& session, const PlcArguments& arguments) {
  const plc::SoakReport report = plc::soak(session, arguments.soak);
  plc::print(report, session.invariants());
  return plc::passed(report) ? 0 : 1;
}

int run(PlcArguments& arguments) {
  modbus::Command& command = arguments.soak.command;
  command.code = plc::command_code_of(arguments.command);
  plc::PlcSession session(arguments.target, {}, !arguments.no_heartbeat && !arguments.watch);
  if (!arguments.flange.empty()) {
    const auto& f = arguments.flange;
    const auto rotation = session.first().decoded.encoding.rotation;
    // What a person types are angles, whatever goes over the wire.
    const auto convention =
        modbus::is_quaternion(rotation) ? map::RotationConvention::kKukaAbc : rotation;
    command.T_base_flange =
        Pose{modbus::rotation_of({f[3] * kDegree, f[4] * kDegree, f[5] * kDegree}, convention),
             {f[0], f[1], f[2]}};
  }
  if (arguments.watch) return watch(session, arguments);
  if (arguments.soak.cycles > 0) return run_soak(session, arguments);
  return hand_shake(session, arguments);
}

}  // namespace

void add_plc_command(CLI::App& app, int& exit_status) {
  auto arguments = std::make_shared<PlcArguments>();
  CLI::App& command = *app.add_subcommand(
      "plc", "Talk to a station as its PLC does: one command step by step, --watch or --soak");
  plc::Target& target = arguments->target;
  plc::SoakOptions& soak = arguments->soak;
  modbus::Command& request = soak.command;
  command.add_option("--host", target.host, "Name or address of the station")->required();
  command.add_option("--port", target.port, "Its port")
      ->capture_default_str()
      ->check(number_between(1, 65535));
  command.add_option("--unit", target.unit_id, "Its unit id")
      ->capture_default_str()
      ->check(number_between(0, 255));
  command
      .add_option("--connect-timeout-ms", target.timeout_ms, "For connecting and for each exchange")
      ->capture_default_str()
      ->check(number_between(1, 600000));
  command
      .add_option("--command", arguments->command,
                  "detect, capture, process, next_page, page, select_recipe, clear_fault, ...")
      ->capture_default_str();
  command.add_option("--recipe", request.recipe, "0: the one in use")
      ->capture_default_str()
      ->check(number_between(0, 65535));
  command.add_option("--picks-max", request.picks_max, "0: the recipe's own limit")
      ->capture_default_str()
      ->check(number_between(0, 65535));
  command.add_option("--deadline-ms", request.deadline_ms, "0: the configured one")
      ->capture_default_str()
      ->check(number_between(0, 65535));
  command.add_option("--page", request.page, "For command page")
      ->capture_default_str()
      ->check(number_between(0, 65535));
  command
      .add_option("--flange", arguments->flange,
                  "Flange pose x,y,z in mm and three angles in deg, in the station's convention "
                  "(KUKA A,B,C where that is a quaternion)")
      ->delimiter(',')
      ->expected(6);
  command.add_option("--timeout-ms", soak.timeout_ms, "For the answer to a command")
      ->capture_default_str()
      ->check(number_between(1, 600000));
  command.add_option("--poll-ms", soak.poll_ms, "Between two reads; --soak: 0 to twice this")
      ->capture_default_str()
      ->check(number_between(0, 60000));
  auto* watch = command.add_flag("--watch", arguments->watch, "Only read; a line for each change");
  command.add_option("--seconds", arguments->seconds, "End of --watch; 0: never")->needs(watch);
  auto* cycles = command.add_option("--soak", soak.cycles,
                                    "So many commands, checking every invariant on every read");
  cycles->capture_default_str()->check(number_between(1, 1000000000))->excludes(watch);
  command.add_option("--seed", soak.seed, "Of the jitter")->needs(cycles);
  command.add_flag("--no-heartbeat", arguments->no_heartbeat, "Leave plc_heartbeat alone");
  command.callback([arguments, &exit_status] { exit_status = run(*arguments); });
}

}  // namespace binpick::app
