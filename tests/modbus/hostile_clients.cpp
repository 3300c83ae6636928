#include "hostile_clients.hpp"

#include <sys/socket.h>
#include <sys/time.h>

#include <chrono>
#include <memory>
#include <random>
#include <stdexcept>

#include "frames.hpp"
#include "raw_client.hpp"

namespace binpick::modbus {
namespace {

const Bytes kRead = frame_of(read_pdu(map::kAnswerStart, map::kAnswerCount));

void pause_ms(int ms) {
  std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

// Empty when the system has no socket or port for the moment: a storm uses them up.
std::unique_ptr<RawClient> connected(int port) {
  try {
    return std::make_unique<RawClient>(port);
  } catch (const std::runtime_error&) {
    pause_ms(1);
    return nullptr;
  }
}

}  // namespace

HostileClients::HostileClients(int port) : port_(port) {
  threads_.emplace_back([this] { stall(); });
  threads_.emplace_back([this] { drip(); });
  threads_.emplace_back([this] { flood(); });
  threads_.emplace_back([this] { talk_nonsense(); });
  threads_.emplace_back([this] { reconnect(); });
}

HostileClients::~HostileClients() {
  stopping_ = true;
  for (std::thread& thread : threads_) thread.join();
}

void HostileClients::stall() {
  while (!stopping_) {
    std::vector<std::unique_ptr<RawClient>> clients;
    for (std::size_t i = 0; i < 4; ++i) {
      clients.push_back(connected(port_));
      if (clients.back()) clients.back()->send(std::span(kRead).first(1 + 2 * i));
    }
    for (int i = 0; i < 50 && !stopping_; ++i) pause_ms(10);
  }
}

void HostileClients::drip() {
  while (!stopping_) {
    const auto client = connected(port_);
    for (std::size_t i = 0; client && !stopping_; ++i) {
      if (!client->send(std::span(kRead).subspan(i % kRead.size(), 1))) break;
      pause_ms(2);
    }
  }
}

void HostileClients::flood() {
  Bytes many;
  for (int i = 0; i < 50; ++i) many.insert(many.end(), kRead.begin(), kRead.end());
  while (!stopping_) {
    const auto client = connected(port_);
    if (!client) continue;
    const timeval patience{.tv_sec = 0, .tv_usec = 20'000};
    ::setsockopt(client->fd(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    // Reads now and then, so that it is not closed at once for being deaf.
    for (int i = 0; !stopping_ && client->send(many); ++i) {
      if (i % 2 == 0 && client->receive(10).empty()) break;
    }
  }
}

void HostileClients::talk_nonsense() {
  std::mt19937 random(3);
  while (!stopping_) {
    const auto client = connected(port_);
    if (!client) continue;
    Bytes bytes = random() % 2 == 0 ? kRead : frame_of(write_many_pdu(0, {1, 2, 3}));
    bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    bytes.resize(1 + random() % bytes.size());
    client->send(bytes);
    client->receive(2);
  }
}

void HostileClients::reconnect() {
  while (!stopping_) {
    const auto client = connected(port_);
    if (client) client->send(kRead);
  }
}

}  // namespace binpick::modbus
