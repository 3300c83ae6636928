// Gray images of 8 or 16 bits as PNG files, written while they are compressed: memory of fixed
// size, taken once, nothing from the heap. Fast rather than small. Thread: one at a time.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <span>

#include "binpick/base/arena.hpp"

namespace binpick::app {

class PngWriter {
 public:
  static std::size_t footprint(int width_max);
  PngWriter(int width_max, Arena& arena);
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  // Writes to `fd` from where it stands; rows without gaps, width up to width_max. The bytes
  // written, or -1: errno says why.
  std::int64_t write(int fd, std::span<const std::uint16_t> pixels, int width);
  std::int64_t write(int fd, std::span<const std::uint8_t> pixels, int width);

 private:
  template <class T>
  std::int64_t write_image(int fd, std::span<const T> pixels, int width);
  bool write_chunk(std::uint32_t type, std::span<const std::uint8_t> data);
  bool deflate_row(std::span<const std::uint8_t> row, int flush);

  z_stream stream_{};
  std::span<std::uint8_t> zlib_memory_, row_, chunk_;
  std::size_t zlib_used_ = 0;
  int fd_ = -1;
  std::int64_t bytes_ = 0;
};

}  // namespace binpick::app
