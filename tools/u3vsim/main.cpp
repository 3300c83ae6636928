// u3vsim: a USB3 Vision 3D sensor without a bus, for tests and for commissioning before the sensor
// arrives. Programs see it that run under umockdev-wrapper with UMOCKDEV_DIR set as it says.
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "control_port.hpp"
#include "steering.hpp"
#include "u3v_device.hpp"
#include "usb_testbed.hpp"
#include "usbfs_emulation.hpp"

namespace binpick::sim {
namespace {

constexpr int kCannotStart = 78;  // EX_CONFIG
constexpr int kUsage = 2;
constexpr int kLeavingMs = 3000;  // for programs to close a sensor that has left

struct Options {
  SensorName name;
  std::string scenes;
  std::optional<int> scene;
  std::string payload = "abcy16";
  double fps = 10;
  bool once = false, chunks = false, usb2 = false;
  int usbfs_memory_mib = 16;
  std::uint64_t seed = 1;
  std::string control;
  std::vector<std::string> faults, false_values;
};

std::string footer() {
  std::string text =
      "A stream carries one image at a time, and Aravis 0.8.26 takes only images of one size: so\n"
      "the depth component alone is enabled at start. The default, Coord3D_ABCY16, has depth and\n"
      "intensity in one image; 'c16' sends depth as the PNG's codes, without intensity.\n"
      "Payloads:\n";
  for (const Personality& personality : personalities()) {
    char line[160];
    std::snprintf(line, sizeof line, "  %-14s %s\n", personality.name, personality.description);
    text += line;
  }
  return text + "Faults, with --fault NAME=VALUE or at run time:\n" + fault_help(kAtUsb3) +
         "While it runs it takes lines from standard input and from --control's socket, and\n"
         "answers each with 'ok', 'ok TEXT' or 'err REASON':\n"
         "  fault NAME VALUE   sets a fault (0 ends it)\n"
         "  false FEATURE VALUE  tells the host this value (list below)\n"
         "  clear              ends all faults and false values\n"
         "  unplug, plug       pulls the cable, puts it in again\n"
         "  trigger [LINE]     an edge on Line0 or Line1\n"
         "  status             counters\n"
         "  kill               ends without goodbye\n"
         "  quit               ends\n"
         "Features that can be false:\n" +
         FalseValues::names();
}

void add_options(CLI::App& app, Options& o) {
  std::vector<std::string> payloads;
  for (const Personality& personality : personalities()) payloads.push_back(personality.name);
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
  app.add_flag("--usb2", o.usb2, "Sit in a port of USB 2, as the wrong cable makes it");
  app.add_option("--usbfs-memory-mb", o.usbfs_memory_mib,
                 "What the kernel lends for USB transfers, MiB; 0: no limit")
      ->check(CLI::Range(0, 65536))
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
        faults_(kAtUsb3),
        device_(sensor_, faults_, {o.name, o.usb2, !o.once, o.seed}),
        usbfs_(device_, faults_, o.name),
        bed_(usbfs_, {o.name, o.usb2, o.usbfs_memory_mib}),
        control_(o.control, [this](const std::string& line) { return handle(line); }) {
    set_at_start(o.faults, o.false_values, faults_, sensor_);
    sensor_.set_commands({[this] { device_.acquisition().start(); },
                          [this] { device_.acquisition().stop(); },
                          [this] { device_.acquisition().trigger(kSourceSoftware); },
                          [this] { device_.power_cycle(); }});
    sensor_.warm_up();
  }

  int image_count() const { return scenes_.count(); }
  const std::string& folder() const { return bed_.folder(); }

  int run() {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM}) sigaddset(&signals, signal);
    const int signal_descriptor = signalfd(-1, &signals, SFD_CLOEXEC);
    while (!quit_) {
      std::vector<pollfd> descriptors = {{signal_descriptor, POLLIN, 0}};
      control_.add_descriptors(descriptors);
      poll(descriptors.data(), descriptors.size(), -1);
      if (descriptors.front().revents != 0) break;
      control_.serve(descriptors);
    }
    device_.acquisition().stop();
    close(signal_descriptor);
    leave();
    return 0;
  }

 private:
  // As a pulled cable: umockdev's library aborts programs whose calls nobody answers any more.
  void leave() {
    bed_.unplug();
    for (int i = 0; i < kLeavingMs && usbfs_.clients() > 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  static SensorOptions sensor_options(const Options& o) {
    SensorOptions options;
    options.name = o.name;
    options.transport = Transport::kUsb3;
    options.personality = find_personality(o.payload);
    options.frame_rate_hz = o.fps;
    if (o.chunks) options.chunks_active = true;
    options.confidence = false;
    return options;
  }

  std::string status() {
    std::ostringstream text;
    text << "ok frames=" << device_.acquisition().frames_made()
         << " dropped=" << device_.frames_dropped() << " plugged=" << bed_.plugged()
         << " clients=" << usbfs_.clients() << " acquiring=" << sensor_.acquiring()
         << " resets=" << usbfs_.resets();
    if (!faults_.text().empty()) text << " faults: " << faults_.text();
    return text.str();
  }

  std::string handle(const std::string& text) {
    const std::optional<SteeringLine> line = parse_line(text);
    if (!line) return "err too many words";
    if (const auto answer = steer(*line, faults_, sensor_, device_.acquisition())) return *answer;
    if (line->verb == "status") return status();
    if (line->verb == "unplug") {
      bed_.unplug();
      device_.power_cycle();
    } else if (line->verb == "plug") {
      bed_.plug();
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
  U3vDevice device_;
  UsbfsEmulation usbfs_;
  UsbTestbed bed_;
  ControlPort control_;
  bool quit_ = false;
};

// Hot-plug events are sent through umockdev's library, which has to be loaded first.
void restart_under_umockdev(char** argv) {
  const char* loaded = std::getenv("LD_PRELOAD");
  const std::string library = "libumockdev-preload.so.0";
  if (loaded != nullptr && std::string(loaded).find(library) != std::string::npos) return;
  setenv("LD_PRELOAD", (library + (loaded == nullptr ? "" : ":" + std::string(loaded))).c_str(), 1);
  execv("/proc/self/exe", argv);
  throw std::runtime_error("cannot be started under umockdev's library");
}

int run(int argc, char** argv) {
  restart_under_umockdev(argv);
  Options options;
  CLI::App app("A USB3 Vision 3D sensor under umockdev, showing a BOP-layout folder.", "u3vsim");
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
  std::printf(
      "u3vsim: ready, serial %s, payload %s, %d images, for programs started with: "
      "UMOCKDEV_DIR=%s umockdev-wrapper PROGRAM\n",
      options.name.serial.c_str(), options.payload.c_str(), simulator.image_count(),
      simulator.folder().c_str());
  std::fflush(stdout);
  return simulator.run();
}

}  // namespace
}  // namespace binpick::sim

int main(int argc, char** argv) {
  try {
    return binpick::sim::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "u3vsim: error: %s\n", e.what());
    return binpick::sim::kCannotStart;
  }
}
