#include "recorder/png_writer.hpp"

#include <array>
#include <cstring>

#include "binpick/base/arena_plan.hpp"
#include "recorder/whole_write.hpp"

namespace binpick::app {
namespace {

// What deflateInit2 asks for, as zconf.h says, and a few KiB for its state.
constexpr int kWindowBits = 15, kMemoryLevel = 8;
constexpr std::size_t kZlibBytes =
    (std::size_t{1} << (kWindowBits + 2)) + (std::size_t{1} << (kMemoryLevel + 9)) + 16384;
// Of compressed data in one IDAT chunk, with 12 bytes of length, type and checksum around it.
constexpr std::size_t kChunkBytes = 65536;
constexpr std::size_t kChunkHead = 8, kChunkTail = 4;

constexpr std::uint32_t chunk_type(const char (&name)[5]) {
  std::uint32_t type = 0;
  for (int i = 0; i < 4; ++i) type = type << 8 | static_cast<std::uint8_t>(name[i]);
  return type;
}

void put32(std::uint8_t* bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
}

// A filter byte and the row's bytes, high byte first, as differences to the pixel on the left.
std::size_t filter_row(const std::uint16_t* pixels, int width, std::uint8_t* out) {
  *out++ = 1;
  unsigned left = 0;
  for (int x = 0; x < width; ++x, out += 2) {
    const unsigned pixel = pixels[x];
    out[0] = static_cast<std::uint8_t>((pixel >> 8) - (left >> 8));
    out[1] = static_cast<std::uint8_t>(pixel - left);
    left = pixel;
  }
  return 1 + 2 * static_cast<std::size_t>(width);
}
std::size_t filter_row(const std::uint8_t* pixels, int width, std::uint8_t* out) {
  *out++ = 1;
  unsigned left = 0;
  for (int x = 0; x < width; ++x) {
    out[x] = static_cast<std::uint8_t>(pixels[x] - left);
    left = pixels[x];
  }
  return 1 + static_cast<std::size_t>(width);
}

struct Memory {
  std::span<std::uint8_t> zlib, row, chunk;
};

template <class Source>
Memory take(Source& source, int width_max) {
  const std::size_t row = 1 + 2 * static_cast<std::size_t>(width_max);
  return {source.template take<std::uint8_t>(kZlibBytes), source.template take<std::uint8_t>(row),
          source.template take<std::uint8_t>(kChunkHead + kChunkBytes + kChunkTail)};
}

}  // namespace

std::size_t PngWriter::footprint(int width_max) {
  ArenaPlan plan;
  take(plan, width_max);
  return plan.bytes;
}

PngWriter::PngWriter(int width_max, Arena& arena) {
  const Memory memory = take(arena, width_max);
  zlib_memory_ = memory.zlib;
  row_ = memory.row;
  chunk_ = memory.chunk;
  stream_.opaque = this;
  stream_.zalloc = [](void* opaque, unsigned items, unsigned size) -> void* {
    auto& self = *static_cast<PngWriter*>(opaque);
    const std::size_t bytes = Arena::padded(std::size_t{items} * size);
    if (bytes > self.zlib_memory_.size() - self.zlib_used_) return nullptr;
    std::uint8_t* block = self.zlib_memory_.data() + self.zlib_used_;
    self.zlib_used_ += bytes;
    return block;
  };
  // The arena's: it is not given back before the arena is.
  stream_.zfree = [](void*, void*) {};
  const int status = deflateInit2(&stream_, 1, Z_DEFLATED, kWindowBits, kMemoryLevel, Z_FILTERED);
  BINPICK_ASSERT(status == Z_OK);
}

bool PngWriter::write_chunk(std::uint32_t type, std::span<const std::uint8_t> data) {
  std::uint8_t* chunk = chunk_.data();
  put32(chunk, static_cast<std::uint32_t>(data.size()));
  put32(chunk + 4, type);
  // IDAT's data stands there already.
  if (!data.empty() && data.data() != chunk + kChunkHead)
    std::memcpy(chunk + kChunkHead, data.data(), data.size());
  const uLong checksum = crc32(0, chunk + 4, static_cast<uInt>(4 + data.size()));
  put32(chunk + kChunkHead + data.size(), static_cast<std::uint32_t>(checksum));
  const std::size_t size = kChunkHead + data.size() + kChunkTail;
  bytes_ += static_cast<std::int64_t>(size);
  return write_whole(fd_, {chunk, size});
}

bool PngWriter::deflate_row(std::span<const std::uint8_t> row, int flush) {
  stream_.next_in = const_cast<std::uint8_t*>(row.data());  // zlib only reads it
  stream_.avail_in = static_cast<uInt>(row.size());
  for (;;) {
    const int status = deflate(&stream_, flush);
    BINPICK_ASSERT(status == Z_OK || status == Z_STREAM_END || status == Z_BUF_ERROR);
    const bool end = status == Z_STREAM_END;
    if (stream_.avail_out > 0 && !end) return true;
    const std::size_t filled = kChunkBytes - stream_.avail_out;
    if (!write_chunk(chunk_type("IDAT"), {chunk_.data() + kChunkHead, filled})) return false;
    stream_.next_out = chunk_.data() + kChunkHead;
    stream_.avail_out = static_cast<uInt>(kChunkBytes);
    if (end) return true;
  }
}

template <class T>
std::int64_t PngWriter::write_image(int fd, std::span<const T> pixels, int width) {
  BINPICK_ASSERT(width > 0 && 1 + sizeof(T) * static_cast<std::size_t>(width) <= row_.size());
  const auto height = static_cast<int>(pixels.size() / static_cast<std::size_t>(width));
  fd_ = fd;
  static constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P',  'N',  'G',
                                                             '\r', '\n', 0x1A, '\n'};
  bytes_ = kSignature.size();
  if (!write_whole(fd, kSignature)) return -1;
  std::array<std::uint8_t, 13> header{};  // gray, deflate, five filters, not interlaced: zeros
  put32(header.data(), static_cast<std::uint32_t>(width));
  put32(header.data() + 4, static_cast<std::uint32_t>(height));
  header[8] = 8 * sizeof(T);
  if (!write_chunk(chunk_type("IHDR"), header)) return -1;

  deflateReset(&stream_);
  stream_.next_out = chunk_.data() + kChunkHead;
  stream_.avail_out = static_cast<uInt>(kChunkBytes);
  for (int y = 0; y < height; ++y) {
    const T* row = pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    const std::size_t bytes = filter_row(row, width, row_.data());
    if (!deflate_row(row_.first(bytes), Z_NO_FLUSH)) return -1;
  }
  if (!deflate_row({}, Z_FINISH) || !write_chunk(chunk_type("IEND"), {})) return -1;
  return bytes_;
}

std::int64_t PngWriter::write(int fd, std::span<const std::uint16_t> pixels, int width) {
  return write_image(fd, pixels, width);
}
std::int64_t PngWriter::write(int fd, std::span<const std::uint8_t> pixels, int width) {
  return write_image(fd, pixels, width);
}

}  // namespace binpick::app
