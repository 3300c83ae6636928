// Numbers in 16-bit registers. A 32-bit value takes two, in the order that the PLC wants;
// libmodbus' own helpers are not used, since two of their four orders are exchanged in Debian's
// version. Thread-safe: no state.
#pragma once

#include <cstdint>
#include <span>

#include "modbus/register_map.hpp"

namespace binpick::modbus {

// value into the first two of `words`.
void put_uint32(std::span<std::uint16_t> words, map::WordOrder order, std::uint32_t value);
void put_int32(std::span<std::uint16_t> words, map::WordOrder order, std::int32_t value);
void put_float32(std::span<std::uint16_t> words, map::WordOrder order, float value);

std::uint32_t get_uint32(std::span<const std::uint16_t> words, map::WordOrder order);
std::int32_t get_int32(std::span<const std::uint16_t> words, map::WordOrder order);
float get_float32(std::span<const std::uint16_t> words, map::WordOrder order);

// The nearest integer, held at the ends of the range; 0 for what is not a number.
std::int32_t rounded_int32(double value);
std::int16_t rounded_int16(double value);
std::uint16_t rounded_uint16(double value);

}  // namespace binpick::modbus
