// binpick sensor-info: what a sensor says of itself, how fast its frames come, and what to improve.
#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <memory>

#include "binpick/drivers/open_camera.hpp"
#include "binpick/drivers/sensor_list.hpp"
#include "binpick/drivers/usb_bus.hpp"
#include "cli/commands.hpp"
#include "cli/drop_table.hpp"
#include "cli/number_between.hpp"
#include "cli/sensor_arguments.hpp"
#include "error_text.hpp"
#include "frame_findings.hpp"

namespace binpick::app {
namespace {

constexpr int kJumboMtu = 9000;

// The network interface that has this address; "" when none has.
std::string interface_of(const std::string& address) {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return "";
  std::string name;
  for (const ifaddrs* i = all; i != nullptr && name.empty(); i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
    char text[INET_ADDRSTRLEN];
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(i->ifa_addr)->sin_addr, text,
              sizeof text);
    if (address == text) name = i->ifa_name;
  }
  freeifaddrs(all);
  return name;
}

long number_in(const std::string& path) {
  long number = -1;
  std::ifstream(path) >> number;
  return number;
}

void advise_network(const drivers::SensorReport& report) {
  const std::string interface = interface_of(report.host_address);
  const long mtu = interface.empty() ? -1 : number_in("/sys/class/net/" + interface + "/mtu");
  const long rmem_max = number_in("/proc/sys/net/core/rmem_max");
  std::printf("\nlink: interface %s, MTU %ld; packet size %d; rmem_max %ld\n",
              interface.empty() ? "unknown" : interface.c_str(), mtu, report.packet_size_bytes,
              rmem_max);
  if (mtu > 0 && mtu < kJumboMtu)
    std::printf(
        "advice: ip link set %s mtu 9000, if sensor and switch allow it: fewer packets cost "
        "less\n",
        interface.c_str());
  if (mtu >= kJumboMtu && report.packet_size_bytes < kJumboMtu / 2)
    std::printf(
        "advice: the link takes packets of %ld bytes but only %d pass: look at sensor and "
        "switch\n",
        mtu, report.packet_size_bytes);
  if (rmem_max >= 0 && static_cast<std::size_t>(rmem_max) < report.payload_bytes)
    std::printf(
        "advice: a frame has %zu bytes, a socket buffer at most %ld: install "
        "60-binpick-net.conf\n",
        report.payload_bytes, rmem_max);
}

void advise_usb(const drivers::SensorReport& report) {
  const long limit_mib = drivers::usbfs_memory_limit_mib();
  const std::vector<drivers::UsbSensor> bus = drivers::list_usb_sensors();
  for (const drivers::UsbSensor& usb : bus) {
    if (usb.serial != report.serial) continue;
    std::printf("\nlink: USB port %s, %s; memory for transfers %s\n", usb.port.c_str(),
                drivers::usb_speed_name(usb.speed),
                limit_mib < 0    ? "unknown"
                : limit_mib == 0 ? "without limit"
                                 : (std::to_string(limit_mib) + " MiB").c_str());
    for (const std::string& warning : drivers::usb_warnings(usb))
      std::printf("advice: %s\n", warning.c_str());
  }
  const std::string advice = drivers::usbfs_memory_advice(limit_mib, static_cast<int>(bus.size()));
  if (!advice.empty()) std::printf("advice: %s\n", advice.c_str());
}

int measure(const SensorArguments& arguments, double seconds, std::size_t payload_bytes) {
  using Clock = std::chrono::steady_clock;
  const drivers::CameraSpec spec = camera_spec_of(arguments);
  const FramePoolParams size{2, arguments.width_max, arguments.height_max};
  Arena arena(FramePool::footprint(size));
  FramePool pool(size, arena);
  const auto camera = drivers::open_camera(spec);
  camera->start(pool);
  tell_missing_features(*camera);
  const auto begun = Clock::now();
  const auto end =
      begun + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  ErrorCode last = ErrorCode::kNone;
  FindingsTold told;
  std::vector<std::string> advice;
  while (Clock::now() < end) {
    if (spec.trigger == drivers::TriggerSource::kSoftware &&
        camera->trigger().code != ErrorCode::kNone)
      break;
    const Result<FrameRef> frame =
        camera->wait_frame(std::min(end, Clock::now() + std::chrono::seconds(1)));
    last = frame.ok() ? ErrorCode::kNone : frame.error().code;
    if (!frame.ok()) continue;
    for (const std::string& sentence : told.fresh(check_frame(frame.value().frame(), {})))
      advice.push_back(sentence);
  }
  const double took_s = std::chrono::duration<double>(Clock::now() - begun).count();
  const drivers::CameraCounters counters = camera->counters();
  const auto frames = static_cast<double>(counters.frames);
  std::printf("\n%.1f s: %.1f frames/s, %.1f MB/s\n", took_s, frames / took_s,
              frames * static_cast<double>(payload_bytes) / took_s * 1e-6);
  print_drops(counters);
  if (counters.packets_missing > 0 || counters.dropped_total() > 0)
    std::printf(
        "advice: frames or packets were lost: larger socket buffers, larger packets, or a "
        "packet delay at the sensor\n");
  for (const std::string& sentence : advice) std::printf("advice: %s\n", sentence.c_str());
  if (counters.frames > 0) return 0;
  std::printf("no frame came%s%s\n", last == ErrorCode::kNone ? "" : ": ",
              last == ErrorCode::kNone ? "" : error_message(last));
  return 1;
}

int show(const SensorArguments& arguments, double seconds) {
  const drivers::SensorReport report = drivers::read_sensor_report(arguments.uri);
  std::printf("%s %s, serial %s\n\n", report.vendor.c_str(), report.model.c_str(),
              report.serial.c_str());
  for (const drivers::FeatureReading& f : report.features)
    std::printf("%-28s %s\n", f.name.c_str(), f.present ? f.value.c_str() : "- (not there)");
  if (report.gige) {
    advise_network(report);
  } else {
    advise_usb(report);
  }
  return seconds > 0 ? measure(arguments, seconds, report.payload_bytes) : 0;
}

}  // namespace

void add_sensor_info_command(CLI::App& app, int& exit_status) {
  auto arguments = std::make_shared<SensorArguments>();
  arguments->trigger = "free";
  auto seconds = std::make_shared<double>(3);
  CLI::App& command =
      *app.add_subcommand("sensor-info", "Show a sensor's features, throughput and losses");
  command.add_option("sensor", arguments->uri, "gev://..., u3v://... or sim:gev")
      ->required()
      ->check([](const std::string& uri) {
        const bool live = drivers::is_live_sensor(uri);
        return live ? std::string() : uri + ": expected gev://..., u3v://... or sim:gev";
      });
  command.add_option("--seconds", *seconds, "How long to measure; 0: not at all")
      ->check(number_between(0.0, 3600.0))
      ->capture_default_str();
  add_sensor_options(command, *arguments);
  command.callback(
      [arguments, seconds, &exit_status] { exit_status = show(*arguments, *seconds); });
}

}  // namespace binpick::app
