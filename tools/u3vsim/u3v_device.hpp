// The simulated sensor as a USB3 Vision device, without the bus: its bootstrap registers, the
// control protocol, and frames as the transfers of the stream.
// Thread-safe: one lock inside for the stream; registers have the sensor's.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "acquisition.hpp"
#include "sensor.hpp"

namespace binpick::sim {

struct U3vOptions {
  SensorName name;
  bool usb2 = false;  // in a port of USB 2: the same device at its lower speed
  bool loop = true;
  std::uint64_t seed = 1;
};

class U3vDevice {
 public:
  U3vDevice(Sensor& sensor, FaultBoard& faults, const U3vOptions& options);

  // A command of the control endpoint; the acknowledgement waits for `take_acknowledgement`.
  void command(std::span<const std::uint8_t> bytes);
  // Empty when there is none.
  std::vector<std::uint8_t> take_acknowledgement();

  // Fills `buffer` with what the stream sends next. Returns the bytes; -1: nothing yet.
  std::ptrdiff_t take_stream(std::span<std::uint8_t> buffer);
  // True as soon as there is something to take, at most after `timeout`.
  bool wait_for_data(std::chrono::microseconds timeout);

  // The device was pulled out, or put in again: as after power-up.
  void power_cycle();
  void clear_halt();  // of the stream's endpoint: what was on its way is gone

  Acquisition& acquisition() { return acquisition_; }
  std::uint64_t frames_dropped() const { return frames_dropped_; }

 private:
  // One transfer of the device: a leader, a piece of the image, or a trailer.
  struct Transfer {
    std::vector<std::uint8_t> own;             // leader and trailer
    std::shared_ptr<const SensorFrame> frame;  // else a range of its bytes
    std::size_t begin = 0, end = 0;
  };
  void add_bootstrap(const U3vOptions& options);
  std::uint16_t execute(std::uint16_t command, std::span<const std::uint8_t> payload,
                        std::vector<std::uint8_t>& answer);
  AccessStatus read(std::uint64_t address, std::span<std::uint8_t> out);
  AccessStatus write(std::uint64_t address, std::span<const std::uint8_t> bytes);
  void after_write(std::uint64_t address);
  void deliver(const SensorFrame& frame);
  std::vector<std::uint8_t> leader(const SensorFrame& frame);
  std::vector<std::uint8_t> trailer(const SensorFrame& frame, std::size_t payload_bytes);
  std::size_t copy(const Transfer& transfer, std::span<std::uint8_t> out) const;

  Sensor& sensor_;
  FaultBoard& faults_;
  Dice dice_;
  std::atomic<std::uint64_t> frames_dropped_{0};

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::vector<std::uint8_t>> acknowledgements_;
  std::deque<Transfer> transfers_;
  int frames_queued_ = 0;
  Acquisition acquisition_;  // last: its thread uses the rest
};

}  // namespace binpick::sim
