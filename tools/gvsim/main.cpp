// gvsim: a GigE Vision 3D sensor at the wire, for tests and for commissioning before the sensor
// arrives. It shows the frames of a BOP-layout folder.
#include <arpa/inet.h>
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "control_port.hpp"
#include "gev_device.hpp"
#include "gvcp_server.hpp"
#include "gvcp_socket.hpp"
#include "steering.hpp"

namespace binpick::sim {
namespace {

constexpr int kCannotStart = 78;  // EX_CONFIG
constexpr int kUsage = 2;
constexpr int kPollMs = 50;  // how late a lost heartbeat may be noticed

struct Options {
  std::string bind = "127.0.0.1";
  SensorName name;
  std::string scenes;
  std::optional<int> scene;
  std::string payload = "c16";
  double fps = 10;
  bool once = false, chunks = false, confidence = false, standard_ids = false;
  double link_mbps = 2500;
  std::uint64_t seed = 1;
  std::string control;
  std::vector<std::string> faults, false_values;
};

std::string footer() {
  std::string text = "Payloads:\n";
  for (const Personality& personality : personalities()) {
    char line[160];
    std::snprintf(line, sizeof line, "  %-14s %s\n", personality.name, personality.description);
    text += line;
  }
  text +=
      "Faults, with --fault NAME=VALUE or at run time:\n" + fault_help(kAtGigE) +
      "While it runs it takes lines from standard input and from --control's socket, and answers\n"
      "each with 'ok', 'ok TEXT' or 'err REASON':\n"
      "  fault NAME VALUE   sets a fault (0 ends it)\n"
      "  false FEATURE VALUE  tells the host this value (list below)\n"
      "  clear              ends all faults and false values\n"
      "  trigger [LINE]     an edge on Line0 or Line1\n"
      "  status             counters\n"
      "  release            takes control away from the host, as a lost heartbeat does\n"
      "  kill               ends without goodbye\n"
      "  quit               ends\n"
      "Block n of a stream (from 1, counted since the stream was opened) shows image\n"
      "(n - 1) modulo the number of images; with standard ids or GevSCCFGMultiPart off each\n"
      "component is a block of its own.\nFeatures that can be false:\n" +
      FalseValues::names();
  return text;
}

void add_options(CLI::App& app, Options& o) {
  std::vector<std::string> payloads;
  for (const Personality& personality : personalities()) payloads.push_back(personality.name);
  app.add_option("--bind", o.bind, "Address of this machine to be the sensor at")
      ->capture_default_str();
  app.add_option("--serial", o.name.serial, "Serial number")->capture_default_str();
  app.add_option("--model", o.name.model, "Model name")->capture_default_str();
  app.add_option("--vendor", o.name.vendor, "Vendor name")->capture_default_str();
  app.add_option("--user-name", o.name.user_name, "User-defined name");
  app.add_option("--scenes", o.scenes, "BOP-layout folder with the frames to show")->required();
  app.add_option("--scene", o.scene, "Scene of it; else the first");
  app.add_option("--payload", o.payload, "What kind of sensor to be (see below)")
      ->check(CLI::IsMember(payloads))
      ->capture_default_str();
  app.add_option("--fps", o.fps, "Frame rate in free run at start, Hz")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
  app.add_flag("--once,!--loop", o.once, "Show each image once; else they are looped");
  app.add_flag("--chunks", o.chunks, "Chunk mode active at start");
  app.add_flag("--confidence", o.confidence, "Confidence component enabled at start");
  app.add_flag("--standard-ids", o.standard_ids, "16-bit block ids at start: no multipart");
  app.add_option("--link-mbps", o.link_mbps, "Pace of the link, Mbit/s; 0: none")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--seed", o.seed, "Of the faults' dice")->capture_default_str();
  app.add_option("--control", o.control, "Unix socket to take lines from");
  app.add_option("--fault", o.faults, "NAME=VALUE, at start; repeat for more");
  app.add_option("--false", o.false_values,
                 "FEATURE=VALUE that the host is told, at start; repeat for more");
  app.footer(footer());
}

class Simulator {
 public:
  explicit Simulator(const Options& o)
      : scenes_(o.scenes, o.scene),
        sensor_(sensor_options(o), scenes_),
        faults_(kAtGigE),
        device_(sensor_, faults_, o.name, gev_options(o)),
        server_(device_),
        sockets_(gev_options(o).address, server_, faults_),
        control_(o.control, [this](const std::string& line) { return handle(line); }) {
    set_at_start(o.faults, o.false_values, faults_, sensor_);
    sensor_.set_commands({[this] { device_.acquisition().start(); },
                          [this] { device_.acquisition().stop(); },
                          [this] { device_.acquisition().trigger(kSourceSoftware); },
                          [this] { device_.release_control(); }});
    sensor_.warm_up();
  }

  int image_count() const { return scenes_.count(); }

  int run() {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM}) sigaddset(&signals, signal);
    const int signal_descriptor = signalfd(-1, &signals, SFD_CLOEXEC);
    while (!quit_) {
      std::vector<pollfd> descriptors = {{signal_descriptor, POLLIN, 0}};
      sockets_.add_descriptors(descriptors);
      control_.add_descriptors(descriptors);
      poll(descriptors.data(), descriptors.size(), kPollMs);
      if (descriptors.front().revents != 0) break;
      sockets_.serve(descriptors);
      control_.serve(descriptors);
      device_.check_heartbeat();
    }
    device_.release_control();
    close(signal_descriptor);
    return 0;
  }

 private:
  static SensorOptions sensor_options(const Options& o) {
    SensorOptions options;
    options.name = o.name;
    options.transport = Transport::kGigE;
    options.personality = find_personality(o.payload);
    options.frame_rate_hz = o.fps;
    if (o.chunks) options.chunks_active = true;
    if (o.confidence) options.confidence = true;
    return options;
  }

  static GevOptions gev_options(const Options& o) {
    GevOptions options;
    if (inet_pton(AF_INET, o.bind.c_str(), &options.address) != 1)
      throw std::runtime_error("--bind " + o.bind + ": is not an IPv4 address");
    options.standard_ids = o.standard_ids;
    options.loop = !o.once;
    options.link_mbps = o.link_mbps;
    options.seed = o.seed;
    return options;
  }

  std::string status() {
    const GvspSender::Counters& c = device_.sender().counters();
    std::ostringstream text;
    text << "ok frames=" << device_.acquisition().frames_made() << " packets=" << c.packets
         << " lost=" << c.lost << " resent=" << c.resent << " unavailable=" << c.unavailable
         << " not_sent=" << c.not_sent << " heartbeats_lost=" << device_.heartbeats_lost()
         << " controlled=" << device_.controlled() << " acquiring=" << sensor_.acquiring();
    if (!faults_.text().empty()) text << " faults: " << faults_.text();
    return text.str();
  }

  std::string handle(const std::string& text) {
    const std::optional<SteeringLine> line = parse_line(text);
    if (!line) return "err too many words";
    const auto answer = steer(*line, faults_, sensor_, device_.acquisition());
    if (answer) {
      if (line->verb == "fault" && *answer == "ok" && faults_.on(kRefuse))
        device_.release_control();
      return *answer;
    }
    if (line->verb == "status") return status();
    if (line->verb == "release") {
      device_.release_control();
    } else if (line->verb == "quit") {
      quit_ = true;
    } else {
      return "err not understood (see --help)";
    }
    return "ok";
  }

  SceneSource scenes_;
  Sensor sensor_;
  FaultBoard faults_;
  GevDevice device_;
  GvcpServer server_;
  GvcpSockets sockets_;
  ControlPort control_;
  bool quit_ = false;
};

int run(int argc, char** argv) {
  Options options;
  CLI::App app("A GigE Vision 3D sensor at the wire, showing a BOP-layout folder.", "gvsim");
  add_options(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    const int status = app.exit(e);
    return status == 0 ? 0 : kUsage;
  }
  // Before any thread starts: signals are for the poll loop alone.
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  Simulator simulator(options);
  std::printf("gvsim: ready at %s, serial %s, payload %s, %d images\n", options.bind.c_str(),
              options.name.serial.c_str(), options.payload.c_str(), simulator.image_count());
  std::fflush(stdout);
  return simulator.run();
}

}  // namespace
}  // namespace binpick::sim

int main(int argc, char** argv) {
  try {
    return binpick::sim::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "gvsim: error: %s\n", e.what());
    return binpick::sim::kCannotStart;
  }
}
