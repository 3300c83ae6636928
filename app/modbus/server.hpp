// The Modbus TCP server: one thread, epoll, a fixed number of clients. No client can hold up
// another: nothing blocks, each turn serves a few requests of each client, and who begins a frame
// and does not end it, does not read its answers or stays silent is closed. What clients read is
// the newest published answer, whole. No allocation after start(). Thread: construct, start, stop
// and destroy on one; the rest is thread-safe as said at each.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "modbus/address_list.hpp"
#include "modbus/answer_image.hpp"
#include "modbus/command_sink.hpp"
#include "modbus/connection.hpp"
#include "modbus/heartbeat_watch.hpp"
#include "modbus/owned_fd.hpp"
#include "modbus/responder.hpp"
#include "modbus/server_counters.hpp"

namespace binpick::modbus {

struct ServerConfig {
  std::string bind_address = "0.0.0.0";
  int port = 502;  // 0: any free one, see Server::port()
  std::uint8_t unit_id = 1;
  int clients_max = 16;
  int idle_timeout_ms = 60'000;          // without a whole request; 0: never
  int frame_timeout_ms = 1'000;          // for a frame once begun, and for answers to be read
  std::vector<Network> allow;            // empty: everybody may connect
  std::optional<std::uint32_t> writer;   // the one address that may write; empty: whoever connects
  int plc_heartbeat_timeout_ms = 2'000;  // 0: never called lost
};

class Server {
 public:
  // Binds and listens; throws app::SetupError. `image` and `sink` outlive the server, which is the
  // one reader of `image`.
  Server(const ServerConfig& config, const Encoding& encoding, AnswerImage& image,
         CommandSink& sink);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  void start();
  void stop();  // closes all connections; does nothing when it does not run

  int port() const { return port_; }
  const ServerCounters& counters() const { return counters_; }  // thread-safe
  Heartbeat plc_heartbeat() const;                              // thread-safe
  int client_count() const { return client_count_.load(); }     // thread-safe

 private:
  void run();
  std::int64_t wait_and_turn(std::int64_t wait_ns);
  void accept_clients(std::int64_t now_ns);
  bool accept_one(std::int64_t now_ns);
  Connection* place_for(bool writer);
  void serve(Connection& client, std::int64_t now_ns);
  bool serve_one(Connection& client, std::int64_t now_ns);
  void count_reply(const Responder::Reply& reply, std::uint8_t function);
  void written(std::int64_t now_ns);
  bool close_if_late(Connection& client, std::int64_t now_ns);
  void close(Connection& client, Count why);
  void update_interest(Connection& client);
  void pause_accepting(std::int64_t now_ns);
  std::int64_t time_to_next_deadline(std::int64_t now_ns) const;

  ServerConfig config_;
  AnswerImage& image_;
  CommandSink& sink_;
  Responder responder_;
  CommandBlock command_block_;
  HeartbeatWatch heartbeat_;
  ServerCounters counters_;
  std::vector<Connection> clients_;  // sized once
  OwnedFd listener_, epoll_, wake_;
  int port_ = 0;
  std::int64_t accept_again_ns_ = 0;  // 0: accepting
  std::atomic<int> client_count_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace binpick::modbus
