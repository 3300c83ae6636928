#include "modbus/connection.hpp"

#include <errno.h>
#include <sys/socket.h>

#include <algorithm>

#include "binpick/base/assert.hpp"

namespace binpick::modbus {
namespace {

bool try_later(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

}  // namespace

void Connection::open(int fd, std::uint32_t peer, bool may_write, std::int64_t now_ns) {
  fd_.reset(fd);
  peer_ = peer;
  may_write_ = may_write;
  last_request_ns_ = now_ns;
  partial_since_ns_ = unsent_since_ns_ = 0;
  reader_.clear();
  out_begin_ = out_end_ = 0;
  epoll_events = 0;
}

// The deadline is of the frame, not of its last byte: dripping bytes does not put it off.
void Connection::note_partial(std::int64_t now_ns) {
  const bool partial = reader_.peek().state == FrameReader::State::kPartial;
  if (!partial) {
    partial_since_ns_ = 0;
  } else if (partial_since_ns_ == 0) {
    partial_since_ns_ = now_ns;
  }
}

Connection::Io Connection::receive(std::int64_t now_ns) {
  const auto space = reader_.space();
  if (space.empty()) return Io::kGood;
  const auto got = ::recv(fd_.get(), space.data(), space.size(), 0);
  if (got == 0) return Io::kEnd;
  if (got < 0) return try_later(errno) ? Io::kGood : Io::kEnd;
  reader_.added(static_cast<std::size_t>(got));
  note_partial(now_ns);
  return Io::kGood;
}

FrameReader::Next Connection::next_frame() const {
  if (!has_room()) return {};
  return reader_.peek();
}

void Connection::answer(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  BINPICK_ASSERT(bytes.size() <= out_.size() - out_end_);
  std::copy(bytes.begin(), bytes.end(), out_.begin() + static_cast<std::ptrdiff_t>(out_end_));
  out_end_ += bytes.size();
  reader_.take();
  last_request_ns_ = now_ns;
  partial_since_ns_ = 0;
  note_partial(now_ns);
}

Connection::Io Connection::send(std::int64_t now_ns) {
  if (out_begin_ == out_end_) return Io::kGood;
  const auto sent =
      ::send(fd_.get(), out_.data() + out_begin_, out_end_ - out_begin_, MSG_NOSIGNAL);
  if (sent < 0 && !try_later(errno)) return Io::kEnd;
  if (sent > 0) out_begin_ += static_cast<std::size_t>(sent);
  if (out_begin_ == out_end_) {
    out_begin_ = out_end_ = 0;
    unsent_since_ns_ = 0;
  } else if (unsent_since_ns_ == 0 || sent > 0) {
    unsent_since_ns_ = now_ns;
  }
  return Io::kGood;
}

bool Connection::wants_to_receive() const {
  return reader_.peek().state != FrameReader::State::kFrame && has_room();
}

}  // namespace binpick::modbus
