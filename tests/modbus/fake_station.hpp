// A station without sensor and detection: takes commands as the real one does and answers with
// made-up picks after a given time. For tests of clients, and to try a PLC program at a desk.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "command_inbox.hpp"
#include "modbus/server.hpp"

namespace binpick::modbus {

struct FakeStationConfig {
  ServerConfig server;
  Encoding encoding;
  int cycle_ms = 30;  // time that finding parts takes
  // Faults that a client has to notice.
  bool tail_differs = false;   // result_sequence_tail stays behind
  bool changes_picks = false;  // a result changes while it should be latched
  bool heartbeat_stands = false;
  bool answers_stale = false;  // answers detect with an old frame
};

// Thread: its own, besides the server's; construct and destroy on one.
class FakeStation {
 public:
  explicit FakeStation(const FakeStationConfig& config);
  ~FakeStation();
  FakeStation(const FakeStation&) = delete;
  FakeStation& operator=(const FakeStation&) = delete;

  int port() const { return server_.port(); }
  const Server& server() const { return server_; }

 private:
  void run();
  void carry_out(const Command& command, std::int64_t taken_ns);
  map::Cause result_of(const Command& command);
  void take_frame();
  void find_parts(const Command& command);
  void show_page(int page);
  void finish(std::uint16_t result_command, map::Cause cause, std::int64_t taken_ns);
  void publish();

  FakeStationConfig config_;
  AnswerImage image_;
  CommandInbox inbox_;
  Server server_;
  AnswerSnapshot answer_;
  std::int64_t capture_ns_ = 0;
  int picks_ = 0;
  bool frame_kept_ = false;
  bool free_running_ = false;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace binpick::modbus
