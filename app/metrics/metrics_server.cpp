#include "metrics/metrics_server.hpp"

#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "binpick/base/arena_plan.hpp"
#include "clock.hpp"
#include "metrics/metrics_listener.hpp"
#include "setup_error.hpp"

namespace binpick::app {
namespace {

constexpr std::size_t kHeadBytes = 256;

template <class Memory>
std::span<char> take_answer(Memory& memory, const MetricRegistry& registry) {
  return memory.template take<char>(kHeadBytes + registry.text_bytes_max());
}

// The whole answer of one that carries no metrics.
constexpr const char* kBadRequest =
    "HTTP/1.0 400 Bad Request\r\nContent-Length: 0\r\nConnection: close\r\n\r\n";
constexpr const char* kNotFound =
    "HTTP/1.0 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n";
constexpr const char* kNotAllowed =
    "HTTP/1.0 405 Method Not Allowed\r\nAllow: GET\r\nContent-Length: 0\r\n"
    "Connection: close\r\n\r\n";

// Null: it asks for the metrics.
const char* refusal_of(std::string_view request) {
  const std::string_view line = request.substr(0, request.find("\r\n"));
  const std::size_t first = line.find(' '), second = line.rfind(' ');
  if (first == std::string_view::npos || second == first) return kBadRequest;
  if (!line.substr(second + 1).starts_with("HTTP/1.")) return kBadRequest;
  if (line.substr(0, first) != "GET") return kNotAllowed;
  std::string_view path = line.substr(first + 1, second - first - 1);
  path = path.substr(0, path.find('?'));
  return path == "/metrics" ? nullptr : kNotFound;
}

}  // namespace

std::size_t MetricsServer::footprint(const MetricRegistry& registry) {
  ArenaPlan plan;
  for (int i = 0; i < kConnectionsMax; ++i) take_answer(plan, registry);
  return plan.bytes;
}

MetricsServer::MetricsServer(const MetricsServerParams& params, const MetricRegistry& registry,
                             Arena& arena)
    : params_(params), registry_(registry) {
  for (Connection& connection : connections_) connection.answer = take_answer(arena, registry);
  const MetricsListener listener = open_metrics_listener(params.listen);
  listener_ = listener.fd;
  port_ = listener.port;
  socket_path_ = listener.socket_path;
  wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake_ < 0) {
    close(listener_);
    throw SetupError(std::string("metrics: no event: ") + std::strerror(errno));
  }
  thread_ = std::thread([this] { work(); });
}

MetricsServer::~MetricsServer() {
  stopping_ = true;
  eventfd_write(wake_, 1);
  thread_.join();
  for (Connection& connection : connections_) end(connection);
  close(listener_);
  close(wake_);
  if (!socket_path_.empty()) unlink(socket_path_.c_str());
}

void MetricsServer::end(Connection& connection) {
  if (connection.fd >= 0) close(connection.fd);
  connection.fd = -1;
}

void MetricsServer::work() {
  pthread_setname_np(pthread_self(), "metrics");
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  while (!stopping_) {
    std::array<pollfd, kConnectionsMax + 2> fds{};
    bool room = false, any = false;
    for (std::size_t i = 0; i < connections_.size(); ++i) {
      const Connection& c = connections_[i];
      room = room || c.fd < 0;
      any = any || c.fd >= 0;
      fds[i] = {c.fd, static_cast<short>(c.answer_bytes > 0 ? POLLOUT : POLLIN), 0};
    }
    // Without room the next ones wait in the kernel's queue.
    fds[kConnectionsMax] = {room ? listener_ : -1, POLLIN, 0};
    fds[kConnectionsMax + 1] = {wake_, POLLIN, 0};
    constexpr int kDeadlineLook_ms = 100;
    poll(fds.data(), fds.size(), any ? kDeadlineLook_ms : -1);
    const std::int64_t now_ns = monotonic_ns();
    for (std::size_t i = 0; i < connections_.size(); ++i) {
      Connection& c = connections_[i];
      if (c.fd >= 0 && fds[i].revents != 0) handle(c);
      if (c.fd >= 0 && now_ns > c.deadline_ns) end(c);
    }
    if (fds[kConnectionsMax].revents != 0) accept_one(now_ns);
  }
}

void MetricsServer::accept_one(std::int64_t now_ns) {
  const auto free = std::find_if(connections_.begin(), connections_.end(),
                                 [](const Connection& c) { return c.fd < 0; });
  const int fd = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (fd < 0) {
    // Out of descriptors, say: not again at once, which would be a busy loop.
    const timespec pause{0, 20'000'000};
    if (errno != EAGAIN && errno != ECONNABORTED) nanosleep(&pause, nullptr);
    return;
  }
  free->fd = fd;
  free->deadline_ns = now_ns + std::int64_t{params_.deadline_ms} * 1'000'000;
  free->request_bytes = free->answer_bytes = free->sent_bytes = 0;
}

void MetricsServer::handle(Connection& connection) {
  if (connection.answer_bytes == 0 && !receive(connection)) return;
  if (connection.answer_bytes > 0 && !send(connection)) return;
  end(connection);
}

// True: the connection is to be answered, or at its end.
bool MetricsServer::receive(Connection& connection) {
  const std::size_t room = connection.request.size() - connection.request_bytes;
  const ssize_t bytes =
      recv(connection.fd, connection.request.data() + connection.request_bytes, room, 0);
  if (bytes < 0 && (errno == EAGAIN || errno == EINTR)) return false;
  if (bytes <= 0) return true;
  connection.request_bytes += static_cast<std::size_t>(bytes);
  const std::string_view request(connection.request.data(), connection.request_bytes);
  const bool whole = request.find("\r\n\r\n") != std::string_view::npos;
  if (!whole && connection.request_bytes < connection.request.size()) return false;
  answer(connection);
  return true;
}

void MetricsServer::answer(Connection& connection) {
  FixedText text(connection.answer);
  const std::string_view request(connection.request.data(), connection.request_bytes);
  const bool whole = request.find("\r\n\r\n") != std::string_view::npos;
  if (const char* refusal = whole ? refusal_of(request) : kBadRequest) {
    text.add(refusal);
  } else {
    requests_.fetch_add(1, std::memory_order_relaxed);
    FixedText body(connection.answer.subspan(kHeadBytes));
    registry_.write(body);
    text.print(
        "HTTP/1.0 200 OK\r\nContent-Type: text/plain; version=0.0.4; charset=utf-8\r\n"
        "Content-Length: %zu\r\nConnection: close\r\n\r\n",
        body.length());
    const std::size_t head = text.length();
    BINPICK_ASSERT(body.whole() && head < kHeadBytes);
    std::memmove(connection.answer.data() + head, body.text().data(), body.length());
    connection.answer_bytes = head + body.length();
    return;
  }
  connection.answer_bytes = text.length();
}

// True: all of it is sent, or nobody takes it.
bool MetricsServer::send(Connection& connection) {
  const ssize_t bytes =
      ::send(connection.fd, connection.answer.data() + connection.sent_bytes,
             connection.answer_bytes - connection.sent_bytes, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (bytes < 0) return errno != EAGAIN && errno != EINTR;
  connection.sent_bytes += static_cast<std::size_t>(bytes);
  return connection.sent_bytes == connection.answer_bytes;
}

}  // namespace binpick::app
