// The stream socket of the simulated sensor: sends blocks at the pace of a link, with the faults
// that are on, and sends packets of the last blocks again when asked.
// Thread-safe: send is for one thread, resend and the test packet for another.
#pragma once

#include <netinet/in.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "fault_board.hpp"
#include "gvsp_block.hpp"

namespace binpick::sim {

class GvspSender {
 public:
  // Throws std::runtime_error when there is no socket at this address. `link_mbps` 0: no pace.
  GvspSender(in_addr address, const FaultBoard& faults, double link_mbps, std::uint64_t seed);
  ~GvspSender();
  GvspSender(const GvspSender&) = delete;
  GvspSender& operator=(const GvspSender&) = delete;

  std::uint16_t port() const { return port_; }

  struct Target {
    sockaddr_in address{};
    bool do_not_fragment = false;
    std::uint64_t packet_delay_ns = 0;
  };
  void send(std::shared_ptr<const GvspBlock> block, const Target& target);
  // What is no longer there is answered with "unavailable".
  void resend(const Target& target, std::uint64_t block_id, std::uint32_t first, std::uint32_t last,
              bool extended_ids);
  // A packet of this size that only tells whether it arrives.
  void send_test_packet(const Target& target, std::uint32_t packet_size);
  void forget_blocks();

  struct Counters {
    std::atomic<std::uint64_t> packets{0}, lost{0}, resent{0}, unavailable{0}, not_sent{0};
  };
  const Counters& counters() const { return counters_; }

 private:
  struct Batch;
  std::vector<std::uint32_t> sending_order(const GvspBlock& block);
  void spoil(GvspPacket& packet, Dice& dice, std::uint8_t* scratch);
  void flush(Batch& batch, const Target& target);
  void set_fragmentation(bool do_not_fragment);

  const FaultBoard& faults_;
  const double ns_per_byte_;
  int socket_ = -1;
  std::uint16_t port_ = 0;
  Counters counters_;
  Dice send_dice_, resend_dice_;
  std::unique_ptr<Batch> send_batch_, resend_batch_;

  std::mutex mutex_;
  std::deque<std::shared_ptr<const GvspBlock>> blocks_;  // newest first
  int fragmentation_ = -1;                               // as set at the socket; -1 not yet
};

}  // namespace binpick::sim
