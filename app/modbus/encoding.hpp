// How poses and 32-bit values look to this PLC: fixed at start by the configuration, and told to
// the PLC in register `conventions`. A pose is twelve registers: x y z as int32, then three int32
// angles or four int16 of a quaternion and two zeros. Thread-safe: no state.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "binpick/geometry/pose.hpp"
#include "modbus/register_map.hpp"

namespace binpick::modbus {

inline constexpr int kPoseWords = 12;

struct Encoding {
  map::WordOrder word_order = map::WordOrder::kAbcd;
  map::RotationConvention rotation = map::RotationConvention::kKukaAbc;
  map::LengthUnit length = map::LengthUnit::kUm;
  map::AngleUnit angle = map::AngleUnit::kDeg1e4;
};

// Register `conventions`.
std::uint16_t conventions_word(const Encoding& encoding);
// Empty when a part is none of the map's lists.
std::optional<Encoding> encoding_of(std::uint16_t conventions_word);

// False, and all words 0, when the pose holds anything but finite numbers.
bool put_pose(std::span<std::uint16_t> words, const Encoding& encoding, const Pose& pose);

// Empty when the words are no pose: a quaternion whose length is more than 1 % off 1.
std::optional<Pose> get_pose(std::span<const std::uint16_t> words, const Encoding& encoding);

}  // namespace binpick::modbus
