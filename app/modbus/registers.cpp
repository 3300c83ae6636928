#include "modbus/registers.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "binpick/base/assert.hpp"

namespace binpick::modbus {
namespace {

std::uint16_t swapped(std::uint16_t word) {
  return static_cast<std::uint16_t>((word >> 8U) | (word << 8U));
}

bool low_word_first(map::WordOrder order) {
  return order == map::WordOrder::kCdab || order == map::WordOrder::kDcba;
}

bool bytes_swapped(map::WordOrder order) {
  return order == map::WordOrder::kBadc || order == map::WordOrder::kDcba;
}

template <class Integer>
Integer rounded(double value) {
  if (std::isnan(value)) return 0;
  const double low = std::numeric_limits<Integer>::min();
  const double high = std::numeric_limits<Integer>::max();
  return static_cast<Integer>(std::clamp(std::round(value), low, high));
}

}  // namespace

void put_uint32(std::span<std::uint16_t> words, map::WordOrder order, std::uint32_t value) {
  BINPICK_ASSERT(words.size() >= 2);
  auto first = static_cast<std::uint16_t>(value >> 16U);
  auto second = static_cast<std::uint16_t>(value & 0xFFFFU);
  if (low_word_first(order)) std::swap(first, second);
  words[0] = bytes_swapped(order) ? swapped(first) : first;
  words[1] = bytes_swapped(order) ? swapped(second) : second;
}

std::uint32_t get_uint32(std::span<const std::uint16_t> words, map::WordOrder order) {
  BINPICK_ASSERT(words.size() >= 2);
  std::uint16_t first = bytes_swapped(order) ? swapped(words[0]) : words[0];
  std::uint16_t second = bytes_swapped(order) ? swapped(words[1]) : words[1];
  if (low_word_first(order)) std::swap(first, second);
  return static_cast<std::uint32_t>(first) << 16U | second;
}

void put_int32(std::span<std::uint16_t> words, map::WordOrder order, std::int32_t value) {
  put_uint32(words, order, static_cast<std::uint32_t>(value));
}

std::int32_t get_int32(std::span<const std::uint16_t> words, map::WordOrder order) {
  return static_cast<std::int32_t>(get_uint32(words, order));
}

void put_float32(std::span<std::uint16_t> words, map::WordOrder order, float value) {
  put_uint32(words, order, std::bit_cast<std::uint32_t>(value));
}

float get_float32(std::span<const std::uint16_t> words, map::WordOrder order) {
  return std::bit_cast<float>(get_uint32(words, order));
}

std::int32_t rounded_int32(double value) {
  return rounded<std::int32_t>(value);
}

std::int16_t rounded_int16(double value) {
  return rounded<std::int16_t>(value);
}

std::uint16_t rounded_uint16(double value) {
  return rounded<std::uint16_t>(value);
}

}  // namespace binpick::modbus
