// fake_station: the fake station as a program. Prints "port N" when it serves; ends when its
// standard input ends, so that it cannot outlive the test that started it.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "fake_station.hpp"

namespace {

template <std::size_t n>
std::uint16_t value_of(const binpick::modbus::map::NamedValue (&names)[n],
                       const std::string& name) {
  for (const auto& known : names) {
    if (name == known.name) return known.value;
  }
  throw std::invalid_argument("the map has no " + name);
}

int run(int argc, char** argv) {
  using namespace binpick::modbus;
  CLI::App app("A station without sensor and detection, answering made-up picks.", "fake_station");
  FakeStationConfig config;
  config.server.port = 0;
  config.server.bind_address = "127.0.0.1";
  std::string order = "abcd";
  std::string rotation = "kuka_abc";
  std::string writer;
  std::vector<std::string> allow;
  app.add_option("--port", config.server.port, "0: any");
  app.add_option("--bind", config.server.bind_address);
  app.add_option("--cycle-ms", config.cycle_ms);
  app.add_option("--heartbeat-timeout-ms", config.server.plc_heartbeat_timeout_ms);
  app.add_option("--word-order", order);
  app.add_option("--rotation", rotation);
  app.add_option("--writer", writer);
  app.add_option("--allow", allow);
  app.add_flag("--tail-differs", config.tail_differs);
  app.add_flag("--changes-picks", config.changes_picks);
  app.add_flag("--heartbeat-stands", config.heartbeat_stands);
  app.add_flag("--answers-stale", config.answers_stale);
  CLI11_PARSE(app, argc, argv);
  config.encoding.word_order = static_cast<map::WordOrder>(value_of(map::kWordOrderNames, order));
  config.encoding.rotation =
      static_cast<map::RotationConvention>(value_of(map::kRotationConventionNames, rotation));
  if (!writer.empty()) config.server.writer = parse_address(writer);
  for (const std::string& network : allow) config.server.allow.push_back(parse_network(network));
  const FakeStation station(config);
  std::printf("port %d\n", station.port());
  std::fflush(stdout);
  char ignored = 0;
  while (::read(STDIN_FILENO, &ignored, 1) > 0) {
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fake_station: %s\n", error.what());
    return 1;
  }
}
