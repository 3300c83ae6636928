// The chain of chunks that ends a payload: data, then its id and its length, again and again, read
// from the end. A payload that lost or gained bytes on the way does not chain to its beginning.
#pragma once

#include <cstdint>
#include <span>

namespace binpick::drivers {

enum class ByteOrder { kBig, kLittle };  // GigE Vision: big; USB3 Vision: little

// True where the chunks fill `bytes` from the first to the last.
bool chunks_fill(std::span<const std::uint8_t> bytes, ByteOrder order);

}  // namespace binpick::drivers
