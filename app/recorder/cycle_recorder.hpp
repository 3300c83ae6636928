// The station's flight recorder: keeps the last cycles in memory and has a thread of the lowest
// priority write them to the disk: all, those around a fault, or those that were asked for. A disk
// that is full or slow costs recordings, which are counted, and nothing else.
// Threads: record() the cycle's; the rest any.
#pragma once

#include <semaphore.h>

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "recorder/record_mode.hpp"
#include "recorder/record_ring.hpp"
#include "recorder/recording_shelf.hpp"
#include "recorder/recording_writer.hpp"

namespace binpick::app {

struct CycleRecorderParams {
  RecordingShelfParams shelf;
  RecordMode mode = RecordMode::kOnFault;
  RecordRingParams ring;
};

struct RecorderCounters {
  std::uint64_t recorded = 0;      // taken into memory
  std::uint64_t written = 0;       // to the disk
  std::uint64_t overwritten = 0;   // in memory, before they could be written
  std::uint64_t write_failed = 0;  // lost to a full or failing disk
  std::uint64_t frame_too_large = 0;
  std::uint64_t recordings_removed = 0;
  std::uint64_t disk_bytes = 0;
  int last_errno = 0;  // of the last failure; 0 again after a success
};

class CycleRecorder {
 public:
  static std::size_t footprint(const CycleRecorderParams& params);
  // The thread starts and waits. Throws SetupError.
  CycleRecorder(const CycleRecorderParams& params,
                std::shared_ptr<const RecordedConfiguration> configuration, Arena& arena);
  // Writes what is to be written, for a few seconds at most.
  ~CycleRecorder();
  CycleRecorder(const CycleRecorder&) = delete;
  CycleRecorder& operator=(const CycleRecorder&) = delete;

  // Copies; neither waits nor allocates.
  void record(const CycleRecord& record);
  // What is in memory now is to be written.
  void write_kept();
  void set_mode(RecordMode mode) { mode_.store(mode, std::memory_order_relaxed); }
  // Of the cycles from now on, which go to another recording.
  void set_configuration(std::shared_ptr<const RecordedConfiguration> configuration);

  RecorderCounters counters() const;

 private:
  // A configuration that is older than so many others may be missing when its cycle is written;
  // the newest is written then.
  static constexpr int kConfigurationsKept = 4;

  void work();
  bool write(const KeptRecord& record);
  bool open_recording(const KeptRecord& record);
  std::shared_ptr<const RecordedConfiguration> configuration(int number) const;

  RecordRing ring_;
  RecordingShelf shelf_;
  RecordingWriter writer_;
  const std::uint64_t recording_bytes_max_;
  int written_configuration_ = -1;  // of the recording that is open; the writer's own

  std::atomic<RecordMode> mode_;
  mutable std::mutex configuration_mutex_;  // never taken by record()
  std::array<std::shared_ptr<const RecordedConfiguration>, kConfigurationsKept> configurations_;
  std::atomic<int> configuration_{0};

  std::atomic<std::uint64_t> recorded_{0}, written_{0}, write_failed_{0}, removed_{0},
      disk_bytes_{0};
  std::atomic<int> last_errno_{0};
  std::atomic<bool> stopping_{false};
  sem_t wake_;          // posting never waits
  std::thread thread_;  // last: everything it uses is made before it
};

}  // namespace binpick::app
