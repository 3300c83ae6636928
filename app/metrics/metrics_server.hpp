// Answers GET /metrics over HTTP on a Unix socket or a port of the loopback interface: one request
// a connection, few connections, each with a deadline, so that nobody who holds one is in the way
// of others for long. Reading metrics touches no thread of the station. Nothing from the heap after
// construction.
#pragma once

#include <array>
#include <atomic>
#include <string>
#include <thread>

#include "binpick/base/arena.hpp"
#include "metrics/metrics.hpp"

namespace binpick::app {

struct MetricsServerParams {
  // A path of a Unix socket (/run/binpick/metrics), or ADDRESS:PORT of the loopback interface
  // (127.0.0.1:9464, [::1]:9464; port 0: any that is free).
  std::string listen;
  int deadline_ms = 2000;  // of a connection, from its acceptance to its end
};

class MetricsServer {
 public:
  static constexpr int kConnectionsMax = 4;

  static std::size_t footprint(const MetricRegistry& registry);
  // Listens, and answers on a thread of its own. The registry outlives it. Throws SetupError.
  MetricsServer(const MetricsServerParams& params, const MetricRegistry& registry, Arena& arena);
  ~MetricsServer();
  MetricsServer(const MetricsServer&) = delete;
  MetricsServer& operator=(const MetricsServer&) = delete;

  int port() const { return port_; }  // 0: a Unix socket
  std::uint64_t requests_count() const { return requests_.load(std::memory_order_relaxed); }

 private:
  struct Connection {
    int fd = -1;
    std::int64_t deadline_ns = 0;
    std::array<char, 2048> request{};
    std::size_t request_bytes = 0;
    std::span<char> answer;
    std::size_t answer_bytes = 0, sent_bytes = 0;
  };
  void work();
  void accept_one(std::int64_t now_ns);
  void handle(Connection& connection);
  bool receive(Connection& connection);
  void answer(Connection& connection);
  bool send(Connection& connection);
  static void end(Connection& connection);

  const MetricsServerParams params_;
  const MetricRegistry& registry_;
  int listener_ = -1, wake_ = -1, port_ = 0;
  std::string socket_path_;
  std::array<Connection, kConnectionsMax> connections_;
  std::atomic<std::uint64_t> requests_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;  // last: everything it uses is made before it
};

}  // namespace binpick::app
