// binpick trigger: gives a running station an order through its control socket and prints the
// answer.
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "setup_error.hpp"

namespace binpick::app {
namespace {

struct TriggerArguments {
  std::vector<std::string> words = {"detect"};
  std::string socket = "/run/binpick/control";
  double timeout_s = 30;
  bool json = false;
};

struct Descriptor {
  explicit Descriptor(int opened) : number(opened) {}
  ~Descriptor() {
    if (number >= 0) close(number);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number;
};

// The answer's line.
std::string ask(const TriggerArguments& arguments) {
  const auto fail = [&](const char* what) {
    throw SetupError(arguments.socket + ": " + what + ": " + std::strerror(errno));
  };
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (arguments.socket.size() >= sizeof address.sun_path)
    throw SetupError(arguments.socket + ": is too long for a socket");
  std::memcpy(address.sun_path, arguments.socket.data(), arguments.socket.size());
  const Descriptor connection(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (connection.number < 0 ||
      connect(connection.number, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    fail("no station answers there");
  const auto seconds = static_cast<time_t>(arguments.timeout_s);
  const timeval patience{seconds, static_cast<suseconds_t>(
                                      (arguments.timeout_s - static_cast<double>(seconds)) * 1e6)};
  setsockopt(connection.number, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  std::string line;
  for (const std::string& word : arguments.words) line += (line.empty() ? "" : " ") + word;
  line += '\n';
  if (send(connection.number, line.data(), line.size(), MSG_NOSIGNAL) !=
      static_cast<ssize_t>(line.size()))
    fail("the order cannot be sent");
  std::string answer;
  char bytes[4096];
  while (answer.empty() || answer.back() != '\n') {
    const ssize_t count = recv(connection.number, bytes, sizeof bytes, 0);
    if (count < 0) fail("no answer");
    if (count == 0) throw SetupError(arguments.socket + ": the station hung up");
    answer.append(bytes, static_cast<std::size_t>(count));
  }
  answer.pop_back();
  return answer;
}

void print_answer(const nlohmann::json& answer) {
  if (answer.contains("fault")) {
    std::printf("%s\n", answer["fault"].get<std::string>().c_str());
    return;
  }
  if (!answer.contains("cause_name")) {
    std::printf("%s\n", answer.dump().c_str());
    return;
  }
  std::printf("cycle %lld: %s: %s, recipe %d, %zu picks of %d, %.1f ms\n",
              answer["cycle"].get<long long>(), answer["order"].get<std::string>().c_str(),
              answer["cause_name"].get<std::string>().c_str(), answer["recipe"].get<int>(),
              answer["picks"].size(), answer["detections"].get<int>(),
              answer["times_ms"]["total"].get<double>());
  for (const nlohmann::json& pick : answer["picks"]) {
    const nlohmann::json& T = pick["T_ref_pick"];
    std::printf("  %9.2f %9.2f %9.2f mm  score %.3f  visible %.2f\n", T[0][3].get<double>(),
                T[1][3].get<double>(), T[2][3].get<double>(), pick["score"].get<double>(),
                pick["visible_fraction"].get<double>());
  }
}

int run(const TriggerArguments& arguments) {
  const std::string line = ask(arguments);
  const nlohmann::json answer = nlohmann::json::parse(line, nullptr, false);
  if (answer.is_discarded() || arguments.json) {
    std::printf("%s\n", line.c_str());
    return answer.is_discarded() || answer.value("ok", false) ? 0 : 1;
  }
  print_answer(answer);
  return answer.value("ok", false) ? 0 : 1;
}

}  // namespace

void add_trigger_command(CLI::App& app, int& exit_status) {
  const auto arguments = std::make_shared<TriggerArguments>();
  CLI::App* command = app.add_subcommand("trigger", "Give a running station an order");
  command
      ->add_option("order", arguments->words,
                   "detect, capture or process with recipe=N picks=N deadline_ms=N; recipe N; page "
                   "N; next_page; clear_fault; free_run on|off; flush; record; status")
      ->capture_default_str();
  command->add_option("--socket", arguments->socket, "The station's control socket")
      ->capture_default_str();
  command->add_option("--timeout-s", arguments->timeout_s, "How long to wait for the answer")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "Print the answer as it came");
  command->callback([arguments, &exit_status] { exit_status = run(*arguments); });
}

}  // namespace binpick::app
