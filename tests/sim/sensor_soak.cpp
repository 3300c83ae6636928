// A long run of the doubles through the real driver, started by a person: 1280x1024 at 20 frames/s,
// each frame in its turn compared with its file, bit for bit. Prints a line a case; the exit status
// is 1 where a bad frame was accepted, or one never came.
//
//   sensor_soak [FRAMES]            all cases
//   sensor_soak FRAMES CASE         one of them: gev-1400, gev-9000, gev-1400-0.002, ..., u3v
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "gev_bench.hpp"

namespace binpick::drivers {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct SoakCase {
  const char* name;
  int packet_size;   // 0: USB
  const char* loss;  // of packets; what is lost is sent again
  bool packet_socket = false;
};

constexpr SoakCase kCases[] = {
    {"gev-1400", 1400, "0"},
    {"gev-9000", 9000, "0"},
    {"gev-1400-0.002", 1400, "0.002"},
    {"gev-1400-0.05", 1400, "0.05"},
    {"gev-9000-0.002", 9000, "0.002"},
    {"gev-9000-0.05", 9000, "0.05"},
    {"u3v", 0, "0"},
    // Where the process may: Aravis then reads packets from memory that it shares with the kernel.
    {"gev-1400-packet-socket", 1400, "0", true},
};

// `who`: the process or the thread that grabs; the others are Aravis'.
double cpu_seconds(__rusage_who who) {
  rusage usage{};
  getrusage(who, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

// Where the bus of u3vsim is, for the library that shows it to this process.
void enter_bus(const std::string& first_line) {
  const std::size_t begin = first_line.find("UMOCKDEV_DIR=") + 13;
  const std::string folder = first_line.substr(begin, first_line.find(' ', begin) - begin);
  setenv("UMOCKDEV_DIR", folder.c_str(), 1);
}

int soak(const SoakCase& c, int count) {
  const bool usb = c.packet_size == 0;
  std::unique_ptr<SimulatorProcess> u3v;  // outlives the camera, whose calls it answers
  // One bench for both: on USB its GigE Vision sensor stands by, unused.
  GevBench b({"--fps", "20"});
  if (usb) {
    u3v = std::make_unique<SimulatorProcess>(
        U3VSIM, std::vector<std::string>{"--scenes", kSampleBin, "--scene", "1", "--serial", "U1",
                                         "--fps", "20"});
    enter_bus(u3v->first_line());
    b.spec.uri = "u3v://serial/U1";
  }
  b.spec.packet_size_bytes = c.packet_size;
  b.spec.packet_socket = c.packet_socket;
  b.spec.trigger = TriggerSource::kFreeRun;
  // A frame that waits for a packet to be sent again is often complete together with the next one.
  b.spec.newest_wins = false;
  b.open();
  if (!usb && b.sim->tell(std::string("fault loss ") + c.loss) != "ok") return 1;
  std::uint64_t bad = 0;
  int timeouts = 0;
  double compare_s = 0;
  std::uint64_t first = 0, last = 0;
  const auto begun = Clock::now();
  const double all_begun_s = cpu_seconds(RUSAGE_SELF), own_begun_s = cpu_seconds(RUSAGE_THREAD);
  // As many frames as the sensor took, whether they arrived or not.
  while (last + 1 < first + static_cast<std::uint64_t>(count) && timeouts < 10) {
    const Result<FrameRef> frame = b.wait(2s);
    if (!frame.ok()) {
      timeouts += frame.error().code == ErrorCode::kSensorTimeout;
      continue;
    }
    last = frame.value().frame().sequence;
    if (first == 0) first = last;
    const double compare_begun = cpu_seconds(RUSAGE_THREAD);
    bad += !b.equals_file(frame.value().frame());
    compare_s += cpu_seconds(RUSAGE_THREAD) - compare_begun;
  }
  const double took_s = std::chrono::duration<double>(Clock::now() - begun).count();
  const double all_s = cpu_seconds(RUSAGE_SELF) - all_begun_s - compare_s;
  const double own_s = cpu_seconds(RUSAGE_THREAD) - own_begun_s - compare_s;
  const CameraCounters n = b.camera->counters();
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf(
      "%-22s %4llu good %llu bad, dropped %llu, missed %llu, underruns %llu, resends %llu, "
      "%.1f frames/s, %.1f %% of a core, of that %.1f %% grabbing\n",
      c.name, number(n.frames - bad), number(bad), number(n.dropped_total()),
      number(n.frames_missed), number(n.underruns), number(n.packets_resent),
      static_cast<double>(n.frames) / took_s, 100 * all_s / took_s, 100 * own_s / took_s);
  std::fflush(stdout);
  const bool whole = timeouts == 0 && n.frames == static_cast<std::uint64_t>(count);
  return bad > 0 || !whole ? 1 : 0;
}

// In a process of its own: on USB with umockdev's library, which has to be there from the start.
int run_case(const char* program, const char* count, const SoakCase& c) {
  const pid_t pid = fork();
  if (pid == 0) {
    if (c.packet_size == 0) setenv("LD_PRELOAD", "libumockdev-preload.so.0", 1);
    execl(program, program, count, c.name, static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 1;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

int run(int argc, char** argv) {
  const char* count = argc > 1 ? argv[1] : "1000";
  if (std::atoi(count) < 1) {
    std::fprintf(stderr, "usage: sensor_soak [FRAMES [CASE]]\n");
    return 2;
  }
  int failed = 0;
  for (const SoakCase& c : kCases) {
    if (argc > 2 && std::strcmp(argv[2], c.name) == 0) {
      const bool ready = c.packet_size > 0 || std::getenv("LD_PRELOAD") != nullptr;
      return ready ? soak(c, std::atoi(count)) : run_case("/proc/self/exe", count, c);
    }
    if (argc <= 2) failed += run_case("/proc/self/exe", count, c) != 0;
  }
  if (argc > 2) std::fprintf(stderr, "there is no case %s\n", argv[2]);
  return failed > 0 || argc > 2 ? 1 : 0;
}

}  // namespace
}  // namespace binpick::drivers

int main(int argc, char** argv) {
  try {
    return binpick::drivers::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "sensor_soak: %s\n", e.what());
    return 1;
  }
}
