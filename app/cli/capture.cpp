// binpick capture: frames of a sensor into a data set.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "cli/commands.hpp"
#include "cli/drop_table.hpp"
#include "cli/number_between.hpp"
#include "cli/progress.hpp"
#include "cli/sensor_arguments.hpp"
#include "error_text.hpp"
#include "frame_findings.hpp"
#include "sensor/frame_writer.hpp"
#include "sensor/live_sensor.hpp"

namespace binpick::app {
namespace {

constexpr int kSlots = 1 /* being written */ + 1 /* being filled */ + 1 /* newest of a free run */;

struct CaptureArguments {
  SensorArguments sensor;
  std::string out;
  int count = 10;
  double depth_scale = 0.1, timeout_s = 10;
};

int capture(const CaptureArguments& a) {
  const drivers::CameraSpec spec = camera_spec_of(a.sensor);
  const FramePoolParams size{kSlots, a.sensor.width_max, a.sensor.height_max};
  Arena arena(FramePool::footprint(size));
  FramePool pool(size, arena);
  try_sensor(spec, pool);  // before a folder is made
  FrameWriter writer(a.out, a.depth_scale);
  LiveSensor sensor(spec, pool, {});
  SensorSession& session = sensor.session();
  Progress progress("capture");
  std::string fault;
  FindingsTold told;
  while (writer.frame_count() < a.count) {
    const Result<FrameRef> frame = grab_within(session, a.timeout_s);
    if (!frame.ok()) {
      fault = error_text(frame.error());
      break;
    }
    for (const std::string& sentence : told.fresh(check_frame(frame.value().frame(), {})))
      std::fprintf(stderr, "binpick: warning: frame %d: %s\n", writer.frame_count(),
                   sentence.c_str());
    writer.write(frame.value().frame());
    progress.update(static_cast<double>(writer.frame_count()) / a.count);
  }
  writer.finish();
  const SessionStatus status = session.status();
  std::printf("%d of %d frames in %s\n", writer.frame_count(), a.count, a.out.c_str());
  print_drops(status.camera);
  if (status.losses > 0)
    std::printf("sensor lost and found again: %llu times\n",
                static_cast<unsigned long long>(status.losses));
  if (status.recoveries > 0)
    std::printf("USB port reset: %llu times\n", static_cast<unsigned long long>(status.recoveries));
  if (fault.empty()) return 0;
  std::fprintf(stderr, "binpick: error: %s: %s\n", spec.uri.c_str(), fault.c_str());
  return 1;
}

}  // namespace

void add_capture_command(CLI::App& app, int& exit_status) {
  auto a = std::make_shared<CaptureArguments>();
  CLI::App& command = *app.add_subcommand("capture", "Write frames of a sensor as a data set");
  command
      .add_option("--sensor", a->sensor.uri,
                  "gev://ADDRESS, gev://serial/N, u3v://serial/N, replay:DIR or sim:gev")
      ->required();
  command.add_option("-n,--count", a->count, "Frames to write")
      ->check(number_between(1, 999999))
      ->capture_default_str();
  command.add_option("-o,--out", a->out, "Folder to make; it may not hold anything yet")
      ->required();
  command.add_option("--depth-scale", a->depth_scale, "mm per unit of the depth images")
      ->check(number_between(1e-4, 100.0))
      ->capture_default_str();
  command.add_option("--timeout-s", a->timeout_s, "How long to wait for a frame")
      ->check(number_between(0.1, 86400.0))
      ->capture_default_str();
  add_sensor_options(command, a->sensor);
  command.callback([a, &exit_status] { exit_status = capture(*a); });
}

}  // namespace binpick::app
