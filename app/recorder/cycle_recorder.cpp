#include "recorder/cycle_recorder.hpp"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>

namespace binpick::app {
namespace {

using std::chrono::steady_clock;

constexpr auto kStopTime = std::chrono::seconds(3);
// So many recordings at least share the disk space, so that one goes when another one comes.
constexpr std::uint64_t kRecordingsInSpace = 4;

// Runs when nobody else wants the processor or the disk. Where the system refuses, the thread has
// the priority of others: less polite, not wrong.
void lower_priority() {
  const auto thread = static_cast<id_t>(syscall(SYS_gettid));
  setpriority(PRIO_PROCESS, thread, 19);
  const sched_param none{};
  sched_setscheduler(0, SCHED_IDLE, &none);
  constexpr int kWhoProcess = 1, kIdleClass = 3 << 13;
  syscall(SYS_ioprio_set, kWhoProcess, 0, kIdleClass);
}

// Signals are for the main thread; a file that is larger than allowed is an error and no signal.
void block_signals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

// Without compression; what the record takes is less, but for a noisy image's few bytes more.
std::uint64_t bytes_of(const KeptRecord& record) {
  constexpr std::uint64_t kBesideImages = 64 << 10;
  return record.pixel_count() * 3 * 65 / 64 + kBesideImages;
}

}  // namespace

std::size_t CycleRecorder::footprint(const CycleRecorderParams& params) {
  return RecordRing::footprint(params.ring) + RecordingWriter::footprint(params.ring.width_max);
}

CycleRecorder::CycleRecorder(const CycleRecorderParams& params,
                             std::shared_ptr<const RecordedConfiguration> configuration,
                             Arena& arena)
    : ring_(params.ring, arena),
      shelf_(params.shelf),
      writer_(params.ring.width_max, arena),
      recording_bytes_max_(params.shelf.bytes_max / kRecordingsInSpace),
      mode_(params.mode) {
  sem_init(&wake_, 0, 0);
  configurations_[0] = std::move(configuration);
  disk_bytes_ = shelf_.bytes();
  thread_ = std::thread([this] { work(); });
}

CycleRecorder::~CycleRecorder() {
  stopping_ = true;
  sem_post(&wake_);
  thread_.join();
  sem_destroy(&wake_);
}

void CycleRecorder::record(const CycleRecord& record) {
  const RecordMode mode = mode_.load(std::memory_order_relaxed);
  const bool fault = record.fault && mode == RecordMode::kOnFault;
  const bool wanted = mode == RecordMode::kAlways || fault;
  ring_.put(record, configuration_.load(std::memory_order_acquire), wanted);
  recorded_.fetch_add(1, std::memory_order_relaxed);
  if (fault) ring_.want_all();
  if (wanted) sem_post(&wake_);
}

void CycleRecorder::write_kept() {
  ring_.want_all();
  sem_post(&wake_);
}

void CycleRecorder::set_configuration(std::shared_ptr<const RecordedConfiguration> configuration) {
  const std::lock_guard lock(configuration_mutex_);
  const int number = configuration_.load(std::memory_order_relaxed) + 1;
  configurations_[static_cast<std::size_t>(number % kConfigurationsKept)] =
      std::move(configuration);
  configuration_.store(number, std::memory_order_release);
}

std::shared_ptr<const RecordedConfiguration> CycleRecorder::configuration(int number) const {
  const std::lock_guard lock(configuration_mutex_);
  return configurations_[static_cast<std::size_t>(number % kConfigurationsKept)];
}

RecorderCounters CycleRecorder::counters() const {
  RecorderCounters counters;
  counters.recorded = recorded_.load(std::memory_order_relaxed);
  counters.written = written_.load(std::memory_order_relaxed);
  counters.overwritten = ring_.overwritten_count();
  counters.write_failed = write_failed_.load(std::memory_order_relaxed);
  counters.frame_too_large = ring_.too_large_count();
  counters.recordings_removed = removed_.load(std::memory_order_relaxed);
  counters.disk_bytes = disk_bytes_.load(std::memory_order_relaxed);
  counters.last_errno = last_errno_.load(std::memory_order_relaxed);
  return counters;
}

void CycleRecorder::work() {
  pthread_setname_np(pthread_self(), "recorder");
  block_signals();
  lower_priority();
  steady_clock::time_point stop_at = steady_clock::time_point::max();
  for (;;) {
    while (sem_wait(&wake_) != 0) {
    }
    while (const KeptRecord* record = ring_.take()) {
      if (stopping_ && stop_at == steady_clock::time_point::max())
        stop_at = steady_clock::now() + kStopTime;
      const bool in_time = steady_clock::now() < stop_at;
      const bool good = in_time && write(*record);
      ring_.give_back(record);
      (good ? written_ : write_failed_).fetch_add(1, std::memory_order_relaxed);
      if (in_time) last_errno_.store(good ? 0 : errno, std::memory_order_relaxed);
      removed_.store(shelf_.removed_count(), std::memory_order_relaxed);
      disk_bytes_.store(shelf_.bytes(), std::memory_order_relaxed);
    }
    if (stopping_) return;
  }
}

bool CycleRecorder::open_recording(const KeptRecord& record) {
  writer_.close();
  if (!shelf_.make_room(bytes_of(record), false)) return false;
  const char* name = shelf_.add(record.unix_ns);
  if (writer_.begin(shelf_.fd(), name, *configuration(record.configuration))) {
    written_configuration_ = record.configuration;
    return true;
  }
  const int error = errno;
  shelf_.drop_newest();
  errno = error;
  return false;
}

bool CycleRecorder::write(const KeptRecord& record) {
  const bool other = !writer_.is_open() || writer_.is_full() || !writer_.takes_frame_of(record) ||
                     written_configuration_ != record.configuration ||
                     static_cast<std::uint64_t>(writer_.bytes()) >= recording_bytes_max_;
  if (other && !open_recording(record)) return false;
  if (!shelf_.make_room(bytes_of(record), true)) return false;
  const bool written = writer_.write(record);
  const int error = errno;
  shelf_.set_newest_bytes(writer_.bytes());
  errno = error;
  return written;
}

}  // namespace binpick::app
