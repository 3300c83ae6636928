#include "genicam/chunk_chain.hpp"

#include <cstddef>

namespace binpick::drivers {
namespace {

constexpr std::size_t kTagBytes = 8;

std::size_t length_before(std::span<const std::uint8_t> bytes, ByteOrder order) {
  const std::uint8_t* p = bytes.data() + bytes.size() - 4;
  if (order == ByteOrder::kBig)
    return std::size_t{p[0]} << 24 | std::size_t{p[1]} << 16 | std::size_t{p[2]} << 8 | p[3];
  return std::size_t{p[3]} << 24 | std::size_t{p[2]} << 16 | std::size_t{p[1]} << 8 | p[0];
}

}  // namespace

bool chunks_fill(std::span<const std::uint8_t> bytes, ByteOrder order) {
  if (bytes.empty()) return false;
  while (!bytes.empty()) {
    if (bytes.size() < kTagBytes) return false;
    const std::size_t length = length_before(bytes, order);
    if (length > bytes.size() - kTagBytes) return false;
    bytes = bytes.first(bytes.size() - kTagBytes - length);
  }
  return true;
}

}  // namespace binpick::drivers
