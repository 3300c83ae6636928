#include "replay/image_end.hpp"

#include <filesystem>
#include <fstream>
#include <string_view>

namespace binpick::drivers {
namespace {

constexpr std::string_view kJpegBegin = "\xFF\xD8", kPngBegin = "\x89PNG\r\n\x1a\n";

std::size_t byte_at(std::string_view bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes[at]);
}

// The position of the next marker's code. In the data of a scan a zero follows on 0xFF, or the
// number of a restart.
std::size_t next_marker(std::string_view bytes, std::size_t at) {
  constexpr std::size_t kFill = 0xFF, kStuffing = 0x00, kRestartFirst = 0xD0, kRestartLast = 0xD7;
  while ((at = bytes.find('\xFF', at)) != bytes.npos && at + 1 < bytes.size()) {
    const std::size_t code = byte_at(bytes, at + 1);
    if (code == kFill) {
      ++at;
    } else if (code == kStuffing || (code >= kRestartFirst && code <= kRestartLast)) {
      at += 2;
    } else {
      return at + 1;
    }
  }
  return bytes.npos;
}

// The pictures within a picture (thumbnails) have ends too: they are in segments, which are
// skipped.
bool jpeg_has_end(std::string_view bytes) {
  constexpr std::size_t kEndOfImage = 0xD9;
  std::size_t at = kJpegBegin.size();
  while ((at = next_marker(bytes, at)) != bytes.npos) {
    if (byte_at(bytes, at) == kEndOfImage) return true;
    if (at + 2 >= bytes.size()) return false;
    at += 1 + (byte_at(bytes, at + 1) << 8 | byte_at(bytes, at + 2));
  }
  return false;
}

// Chunks of length, name, content and checksum.
bool png_has_end(std::string_view bytes) {
  constexpr std::size_t kFrame = 12;
  std::size_t at = kPngBegin.size();
  while (at + kFrame <= bytes.size()) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | byte_at(bytes, at + i);
    if (bytes.substr(at + 4, 4) == "IEND") return true;
    at += kFrame + length;
  }
  return false;
}

}  // namespace

bool ends_too_early(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(kPngBegin.size(), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  const bool jpeg = bytes.starts_with(kJpegBegin);
  if (!jpeg && bytes != kPngBegin) return false;
  std::error_code error;
  bytes.resize(std::filesystem::file_size(path, error));
  file.clear();
  file.seekg(0);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return jpeg ? !jpeg_has_end(bytes) : !png_has_end(bytes);
}

}  // namespace binpick::drivers
