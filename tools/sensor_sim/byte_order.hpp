// Numbers in the byte order of a wire or of a register, whatever that of the machine.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace binpick::sim {

enum class ByteOrder { kBig, kLittle };

template <class T>
void put(std::uint8_t* out, T value, ByteOrder order) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    const std::size_t shift = 8 * (order == ByteOrder::kBig ? sizeof(T) - 1 - i : i);
    out[i] = static_cast<std::uint8_t>(value >> shift);
  }
}

template <class T>
T get(const std::uint8_t* in, ByteOrder order) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    const std::size_t shift = 8 * (order == ByteOrder::kBig ? sizeof(T) - 1 - i : i);
    value = static_cast<T>(value | static_cast<T>(in[i]) << shift);
  }
  return value;
}

inline void put_be16(std::uint8_t* out, std::uint16_t v) {
  put(out, v, ByteOrder::kBig);
}
inline void put_be32(std::uint8_t* out, std::uint32_t v) {
  put(out, v, ByteOrder::kBig);
}
inline void put_be64(std::uint8_t* out, std::uint64_t v) {
  put(out, v, ByteOrder::kBig);
}
inline std::uint16_t get_be16(const std::uint8_t* in) {
  return get<std::uint16_t>(in, ByteOrder::kBig);
}
inline std::uint32_t get_be32(const std::uint8_t* in) {
  return get<std::uint32_t>(in, ByteOrder::kBig);
}
inline std::uint64_t get_be64(const std::uint8_t* in) {
  return get<std::uint64_t>(in, ByteOrder::kBig);
}

inline void put_le16(std::uint8_t* out, std::uint16_t v) {
  put(out, v, ByteOrder::kLittle);
}
inline void put_le32(std::uint8_t* out, std::uint32_t v) {
  put(out, v, ByteOrder::kLittle);
}
inline void put_le64(std::uint8_t* out, std::uint64_t v) {
  put(out, v, ByteOrder::kLittle);
}

inline std::uint64_t bits_of(double value) {
  return std::bit_cast<std::uint64_t>(value);
}
inline double double_of(std::uint64_t bits) {
  return std::bit_cast<double>(bits);
}

}  // namespace binpick::sim
