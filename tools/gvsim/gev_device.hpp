// The simulated sensor as a GigE Vision device: its bootstrap registers, who controls it, and the
// way of its frames to the stream socket.
// Thread: one calls everything here (the control channel's); frames are sent by the acquisition's.
#pragma once

#include <netinet/in.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "acquisition.hpp"
#include "gvsp_sender.hpp"
#include "sensor.hpp"

namespace binpick::sim {

struct GevOptions {
  in_addr address{};
  bool standard_ids = false;  // at start; GevGVSPExtendedIDMode changes it
  bool loop = true;
  double link_mbps = 2500;
  std::uint64_t seed = 1;
};

class GevDevice {
 public:
  using Clock = std::chrono::steady_clock;

  GevDevice(Sensor& sensor, FaultBoard& faults, const SensorName& name, const GevOptions& options);

  // Accesses by `host`, with the rules of the control channel's privilege.
  enum class Verdict { kAllowed, kDenied };
  Verdict may_read(const sockaddr_in& host, std::uint64_t address);
  Verdict may_write(const sockaddr_in& host, std::uint64_t address);
  AccessStatus read(std::uint64_t address, std::span<std::uint8_t> out);
  AccessStatus write(const sockaddr_in& host, std::uint64_t address,
                     std::span<const std::uint8_t> bytes);
  void resend(const sockaddr_in& host, std::uint64_t block_id, std::uint32_t first,
              std::uint32_t last, bool extended_ids);

  bool controlled_by(const sockaddr_in& host) const;
  // The controlling host was heard; its heartbeat starts anew.
  void heard() { last_heard_ = Clock::now(); }
  // Releases control when the host was not heard for its heartbeat timeout.
  void check_heartbeat();
  void release_control();

  Acquisition& acquisition() { return acquisition_; }
  const GvspSender& sender() const { return sender_; }
  std::uint64_t heartbeats_lost() const { return heartbeats_lost_; }
  bool controlled() const { return controller_.has_value(); }

 private:
  void add_bootstrap(const SensorName& name, const GevOptions& options);
  void describe(const SensorName& name, in_addr address);
  AccessStatus check_bootstrap(std::uint64_t address, std::uint32_t value);
  void after_write(std::uint64_t address, std::uint32_t value);
  AccessStatus write_privilege(const sockaddr_in& host, std::uint32_t value);
  GvspSender::Target stream_target();
  bool multipart();
  void deliver(const SensorFrame& frame);

  Sensor& sensor_;
  FaultBoard& faults_;
  GvspSender sender_;
  Dice dice_;
  std::optional<sockaddr_in> controller_;
  bool exclusive_ = false;
  Clock::time_point last_heard_;
  std::uint64_t heartbeats_lost_ = 0;
  std::uint64_t timestamp_zero_ns_ = 0;
  Acquisition acquisition_;  // last: its thread uses the rest
};

}  // namespace binpick::sim
