#include "modbus/server.hpp"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <pthread.h>
#include <signal.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>

#include "binpick/base/assert.hpp"
#include "clock.hpp"
#include "modbus/listener.hpp"
#include "setup_error.hpp"

namespace binpick::modbus {
namespace {

// Of one client before the others' turn: what a flood costs the rest is this many microseconds.
constexpr int kRequestsPerTurn = 4;
constexpr int kAcceptsPerTurn = 8;
constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kAcceptPauseNs = 100 * kMs;
constexpr std::int64_t kNever = 3'600'000 * kMs;
// What epoll calls the listener and the wake-up; clients are called by their index.
constexpr std::uint64_t kListenerKey = 1U << 16U;
constexpr std::uint64_t kWakeKey = kListenerKey + 1;

void watch(int epoll, int operation, int fd, std::uint32_t events, std::uint64_t key) {
  epoll_event event{.events = events, .data = {.u64 = key}};
  ::epoll_ctl(epoll, operation, fd, &event);
}

}  // namespace

Server::Server(const ServerConfig& config, const Encoding& encoding, AnswerImage& image,
               CommandSink& sink)
    : config_(config),
      image_(image),
      sink_(sink),
      responder_(config.unit_id, encoding),
      heartbeat_(config.plc_heartbeat_timeout_ms),
      clients_(static_cast<std::size_t>(std::clamp(config.clients_max, 1, 1024))),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (!epoll_ || !wake_) throw app::SetupError("no descriptors for the Modbus server");
  Listener listener = listen_on(config_.bind_address, config_.port);
  listener_ = std::move(listener.fd);
  port_ = listener.port;
  watch(epoll_.get(), EPOLL_CTL_ADD, listener_.get(), EPOLLIN, kListenerKey);
  watch(epoll_.get(), EPOLL_CTL_ADD, wake_.get(), EPOLLIN, kWakeKey);
}

Server::~Server() {
  stop();
}

void Server::start() {
  BINPICK_ASSERT(!thread_.joinable());
  stopping_ = false;
  // Signals are the main thread's.
  sigset_t all;
  sigset_t before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { run(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

void Server::stop() {
  if (!thread_.joinable()) return;
  stopping_ = true;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(wake_.get(), &one, sizeof one);
  thread_.join();
  for (Connection& client : clients_) client.close();
  client_count_ = 0;
}

Heartbeat Server::plc_heartbeat() const {
  return heartbeat_.state(app::monotonic_ns());
}

void Server::run() {
  pthread_setname_np(pthread_self(), "modbus");
  std::int64_t wait_ns = 0;
  while (!stopping_) wait_ns = wait_and_turn(wait_ns);
}

// One turn: what came, a few requests of each client, who is late. Returns how long nothing is due.
std::int64_t Server::wait_and_turn(std::int64_t wait_ns) {
  std::array<epoll_event, 64> events;
  const int wait_ms = static_cast<int>((wait_ns + kMs - 1) / kMs);
  const int count = ::epoll_wait(epoll_.get(), events.data(), events.size(), wait_ms);
  const std::int64_t now_ns = app::monotonic_ns();
  for (int i = 0; i < count; ++i) {
    const auto& [happened, data] = events[static_cast<std::size_t>(i)];
    if (data.u64 == kWakeKey) {
      std::uint64_t ignored = 0;
      [[maybe_unused]] const auto got = ::read(wake_.get(), &ignored, sizeof ignored);
    } else if (data.u64 == kListenerKey) {
      accept_clients(now_ns);
    } else {
      Connection& client = clients_[data.u64];
      if (!client.is_open()) continue;  // its place was given away in this turn
      const bool receives = (happened & (EPOLLIN | EPOLLHUP | EPOLLERR)) != 0;
      if (receives && client.receive(now_ns) == Connection::Io::kEnd) {
        close(client, Count::kClosedByClient);
      }
    }
  }
  for (Connection& client : clients_) {
    if (client.is_open()) serve(client, now_ns);
  }
  if (accept_again_ns_ != 0 && now_ns >= accept_again_ns_) {
    accept_again_ns_ = 0;
    watch(epoll_.get(), EPOLL_CTL_MOD, listener_.get(), EPOLLIN, kListenerKey);
  }
  return time_to_next_deadline(now_ns);
}

void Server::accept_clients(std::int64_t now_ns) {
  for (int i = 0; i < kAcceptsPerTurn; ++i) {
    if (!accept_one(now_ns)) return;
  }
}

bool Server::accept_one(std::int64_t now_ns) {
  sockaddr_in address{};
  socklen_t length = sizeof address;
  OwnedFd fd(::accept4(listener_.get(), reinterpret_cast<sockaddr*>(&address), &length,
                       SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!fd) {
    if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
      pause_accepting(now_ns);
    }
    return errno == ECONNABORTED || errno == EINTR;
  }
  const std::uint32_t peer = ntohl(address.sin_addr.s_addr);
  if (!allowed(config_.allow, peer)) {
    counters_.add(Count::kRefusedAddress);
    return true;
  }
  const bool is_writer = config_.writer && *config_.writer == peer;
  Connection* place = place_for(is_writer);
  if (place == nullptr) {
    counters_.add(Count::kRefusedLimit);
    return true;
  }
  const int raw = fd.release();
  tune_client_socket(raw);
  place->open(raw, peer, is_writer || !config_.writer, now_ns);
  place->epoll_events = EPOLLIN;
  watch(epoll_.get(), EPOLL_CTL_ADD, raw, EPOLLIN,
        static_cast<std::uint64_t>(place - clients_.data()));
  ++client_count_;
  counters_.add(Count::kAccepted);
  return true;
}

// The PLC that may write always gets a place: after its power came back, its old connections may
// still hold all of them. The one that was silent longest gives way.
Connection* Server::place_for(bool writer) {
  const auto free = std::find_if(clients_.begin(), clients_.end(),
                                 [](const Connection& client) { return !client.is_open(); });
  if (free != clients_.end()) return &*free;
  if (!writer) return nullptr;
  Connection& oldest = *std::min_element(clients_.begin(), clients_.end(),
                                         [](const Connection& a, const Connection& b) {
                                           return a.last_request_ns() < b.last_request_ns();
                                         });
  close(oldest, Count::kReplacedByWriter);
  return &oldest;
}

// Level-triggered and out of descriptors, the loop would spin.
void Server::pause_accepting(std::int64_t now_ns) {
  counters_.add(Count::kAcceptPaused);
  accept_again_ns_ = now_ns + kAcceptPauseNs;
  watch(epoll_.get(), EPOLL_CTL_MOD, listener_.get(), 0, kListenerKey);
}

void Server::serve(Connection& client, std::int64_t now_ns) {
  for (int i = 0; i < kRequestsPerTurn; ++i) {
    if (!serve_one(client, now_ns)) break;
  }
  if (!client.is_open()) return;
  if (client.send(now_ns) == Connection::Io::kEnd) return close(client, Count::kClosedByClient);
  if (!close_if_late(client, now_ns)) update_interest(client);
}

// False when the client has nothing more for this turn.
bool Server::serve_one(Connection& client, std::int64_t now_ns) {
  const FrameReader::Next next = client.next_frame();
  switch (next.state) {
    case FrameReader::State::kEmpty:
    case FrameReader::State::kPartial:
      return false;
    case FrameReader::State::kWrongProtocol:
      close(client, Count::kWrongProtocol);
      return false;
    case FrameReader::State::kWrongLength:
      close(client, Count::kWrongLength);
      return false;
    case FrameReader::State::kFrame:
      break;
  }
  responder_.show(image_.latest(), app::monotonic_ns());
  const Responder::Reply reply = responder_.reply(next.frame, client.may_write());
  count_reply(reply, next.frame[kMbapBytes]);
  client.answer(reply.bytes, now_ns);
  if (reply.wrote) written(now_ns);
  return true;
}

void Server::count_reply(const Responder::Reply& reply, std::uint8_t function) {
  switch (reply.exception) {
    case Exception::kNone:
      break;
    case Exception::kIllegalFunction:
      return counters_.add(Count::kIllegalFunction);
    case Exception::kIllegalAddress:
      return counters_.add(Count::kIllegalAddress);
    case Exception::kIllegalValue:
      return counters_.add(Count::kIllegalValue);
    case Exception::kServerFailure:
      return counters_.add(Count::kServerFailure);
    case Exception::kTargetSilent:
      return counters_.add(Count::kTargetSilent);
  }
  switch (static_cast<Function>(function)) {
    case Function::kReadHolding:
      return counters_.add(Count::kReadHolding);
    case Function::kReadInput:
      return counters_.add(Count::kReadInput);
    case Function::kWriteOne:
      return counters_.add(Count::kWriteOne);
    case Function::kWriteMany:
      return counters_.add(Count::kWriteMany);
    case Function::kReadWriteMany:
      return counters_.add(Count::kReadWriteMany);
  }
}

void Server::written(std::int64_t now_ns) {
  const auto registers = responder_.command_registers();
  heartbeat_.seen(registers[map::kAddressPlcHeartbeat - map::kCommandStart], now_ns);
  if (!command_block_.starts(registers)) return;
  TakenCommand command;
  std::copy(registers.begin(), registers.end(), command.registers.begin());
  command.taken_ns = now_ns;
  counters_.add(Count::kCommands);
  sink_.put(command);
}

bool Server::close_if_late(Connection& client, std::int64_t now_ns) {
  const auto late = [&](std::int64_t since_ns, int timeout_ms) {
    return since_ns != 0 && timeout_ms > 0 && now_ns - since_ns >= timeout_ms * kMs;
  };
  if (late(client.partial_since_ns(), config_.frame_timeout_ms)) {
    close(client, Count::kClosedPartialFrame);
  } else if (late(client.unsent_since_ns(), config_.frame_timeout_ms)) {
    close(client, Count::kClosedUnread);
  } else if (late(client.last_request_ns(), config_.idle_timeout_ms)) {
    close(client, Count::kClosedIdle);
  }
  return !client.is_open();
}

void Server::close(Connection& client, Count why) {
  // Counted first: who sees the connection end finds it counted.
  counters_.add(why);
  --client_count_;
  client.close();  // epoll forgets a closed descriptor by itself
}

void Server::update_interest(Connection& client) {
  const std::uint32_t events =
      (client.wants_to_receive() ? EPOLLIN : 0U) | (client.wants_to_send() ? EPOLLOUT : 0U);
  if (events == client.epoll_events) return;
  client.epoll_events = events;
  watch(epoll_.get(), EPOLL_CTL_MOD, client.fd(), events,
        static_cast<std::uint64_t>(&client - clients_.data()));
}

std::int64_t Server::time_to_next_deadline(std::int64_t now_ns) const {
  std::int64_t next_ns = accept_again_ns_ != 0 ? accept_again_ns_ : now_ns + kNever;
  const auto consider = [&](std::int64_t since_ns, int timeout_ms) {
    if (since_ns != 0 && timeout_ms > 0) next_ns = std::min(next_ns, since_ns + timeout_ms * kMs);
  };
  for (const Connection& client : clients_) {
    if (!client.is_open()) continue;
    // Requests left over from this turn, or an end that was not looked at yet.
    const auto state = client.next_frame().state;
    if (state != FrameReader::State::kEmpty && state != FrameReader::State::kPartial) return 0;
    consider(client.partial_since_ns(), config_.frame_timeout_ms);
    consider(client.unsent_since_ns(), config_.frame_timeout_ms);
    consider(client.last_request_ns(), config_.idle_timeout_ms);
  }
  return std::max<std::int64_t>(next_ns - now_ns, 0);
}

}  // namespace binpick::modbus
