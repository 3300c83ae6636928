// One client: its socket, the bytes that came and the bytes that wait to go, all of fixed size, and
// the times by which it is judged. Never blocks. Thread: the server's.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "modbus/mbap.hpp"
#include "modbus/owned_fd.hpp"

namespace binpick::modbus {

class Connection {
 public:
  void open(int fd, std::uint32_t peer, bool may_write, std::int64_t now_ns);
  void close() { fd_.reset(); }
  bool is_open() const { return static_cast<bool>(fd_); }

  int fd() const { return fd_.get(); }
  std::uint32_t peer() const { return peer_; }  // host byte order
  bool may_write() const { return may_write_; }
  std::int64_t last_request_ns() const { return last_request_ns_; }

  enum class Io { kGood, kEnd };  // kEnd: the client closed, or the connection broke
  Io receive(std::int64_t now_ns);
  Io send(std::int64_t now_ns);

  // The first whole frame, while there is room for its answer; or why there will be none.
  FrameReader::Next next_frame() const;
  bool has_room() const { return out_end_ + kFrameBytesMax <= out_.size(); }
  // The answer to the frame that next_frame() gave.
  void answer(std::span<const std::uint8_t> bytes, std::int64_t now_ns);

  bool wants_to_receive() const;
  bool wants_to_send() const { return out_begin_ < out_end_; }
  // Since when a frame has been waiting for its rest, and answers to be sent on; 0: not.
  std::int64_t partial_since_ns() const { return partial_since_ns_; }
  std::int64_t unsent_since_ns() const { return unsent_since_ns_; }

  // What epoll was last told to wait for; the server's own note.
  std::uint32_t epoll_events = 0;

 private:
  void note_partial(std::int64_t now_ns);

  OwnedFd fd_;
  std::uint32_t peer_ = 0;
  bool may_write_ = false;
  std::int64_t last_request_ns_ = 0;
  std::int64_t partial_since_ns_ = 0;
  std::int64_t unsent_since_ns_ = 0;
  FrameReader reader_;
  std::array<std::uint8_t, 4096> out_{};
  std::size_t out_begin_ = 0;
  std::size_t out_end_ = 0;
};

}  // namespace binpick::modbus
