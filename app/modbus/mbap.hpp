// Modbus TCP frames out of a byte stream that may come in any pieces: the MBAP header (transaction,
// protocol, length, unit) and the request behind it. No sockets, no clock, no allocation; a buffer
// of fixed size a client. Thread: the owner's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace binpick::modbus {

inline constexpr std::size_t kMbapBytes = 7;        // header, unit id included
inline constexpr std::size_t kFrameBytesMax = 260;  // header and 253 bytes of request

class FrameReader {
 public:
  enum class State {
    kEmpty,          // no byte of a next frame is there
    kPartial,        // a frame has begun: its deadline runs
    kFrame,          // `frame` is a whole one
    kWrongProtocol,  // protocol id is not 0: what follows cannot be trusted; close
    kWrongLength,    // the length field is none of a request: close
  };
  struct Next {
    State state = State::kEmpty;
    std::span<const std::uint8_t> frame;  // header included; valid until space() or take()
  };

  // Where to put further bytes; never empty unless a whole frame waits.
  std::span<std::uint8_t> space();
  void added(std::size_t bytes);

  // Looks at the first frame, leaving it where it is.
  Next peek() const;
  // Drops the frame that peek() gave.
  void take();
  void clear() { begin_ = end_ = 0; }

 private:
  // Room for some requests sent at once: 85 reads of 12 bytes.
  std::array<std::uint8_t, 1024> bytes_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace binpick::modbus
