#include "modbus/encoding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "binpick/base/assert.hpp"
#include "binpick/geometry/angle.hpp"
#include "modbus/registers.hpp"
#include "modbus/rotation.hpp"

namespace binpick::modbus {
namespace {

constexpr int kRotationStart = 6;
constexpr double kQuaternionScale = 32767;
constexpr double kQuaternionLengthTolerance = 0.01;

double lengths_per_mm(map::LengthUnit unit) {
  return unit == map::LengthUnit::kUm ? 1000.0 : 1e4 / 25.4;
}

double angles_per_rad(map::AngleUnit unit) {
  return unit == map::AngleUnit::kDeg1e4 ? 1 / kDegree * 1e4 : 1e6;
}

template <std::size_t n>
bool holds(const map::NamedValue (&names)[n], unsigned value) {
  return std::any_of(std::begin(names), std::end(names),
                     [&](const map::NamedValue& name) { return name.value == value; });
}

}  // namespace

std::uint16_t conventions_word(const Encoding& encoding) {
  const auto word =
      static_cast<unsigned>(encoding.rotation) | static_cast<unsigned>(encoding.word_order) << 8U |
      static_cast<unsigned>(encoding.length) << 10U | static_cast<unsigned>(encoding.angle) << 11U;
  return static_cast<std::uint16_t>(word);
}

std::optional<Encoding> encoding_of(std::uint16_t conventions_word) {
  const unsigned rotation = conventions_word & 0xFFU;
  if (!holds(map::kRotationConventionNames, rotation) || conventions_word >> 12U != 0) return {};
  return Encoding{
      .word_order = static_cast<map::WordOrder>(conventions_word >> 8U & 3U),
      .rotation = static_cast<map::RotationConvention>(rotation),
      .length = static_cast<map::LengthUnit>(conventions_word >> 10U & 1U),
      .angle = static_cast<map::AngleUnit>(conventions_word >> 11U & 1U),
  };
}

bool put_pose(std::span<std::uint16_t> words, const Encoding& encoding, const Pose& pose) {
  BINPICK_ASSERT(words.size() >= kPoseWords);
  std::fill_n(words.begin(), kPoseWords, std::uint16_t{0});
  if (!pose.R.allFinite() || !pose.t_mm.allFinite()) return false;
  const double length = lengths_per_mm(encoding.length);
  for (int i = 0; i < 3; ++i) {
    put_int32(words.subspan(static_cast<std::size_t>(2 * i)), encoding.word_order,
              rounded_int32(pose.t_mm[i] * length));
  }
  const auto rotation = words.subspan(kRotationStart);
  if (is_quaternion(encoding.rotation)) {
    const auto q = quaternion_of(pose.R, encoding.rotation);
    std::transform(q.begin(), q.end(), rotation.begin(), [](double part) {
      return static_cast<std::uint16_t>(rounded_int16(part * kQuaternionScale));
    });
    return true;
  }
  const auto angles = angles_of(pose.R, encoding.rotation);
  for (std::size_t i = 0; i < 3; ++i) {
    put_int32(rotation.subspan(2 * i), encoding.word_order,
              rounded_int32(angles[i] * angles_per_rad(encoding.angle)));
  }
  return true;
}

std::optional<Pose> get_pose(std::span<const std::uint16_t> words, const Encoding& encoding) {
  BINPICK_ASSERT(words.size() >= kPoseWords);
  Pose pose;
  for (int i = 0; i < 3; ++i) {
    const auto word = words.subspan(static_cast<std::size_t>(2 * i));
    pose.t_mm[i] = get_int32(word, encoding.word_order) / lengths_per_mm(encoding.length);
  }
  const auto rotation = words.subspan(kRotationStart);
  if (is_quaternion(encoding.rotation)) {
    std::array<double, 4> q{};
    double square = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      q[i] = static_cast<std::int16_t>(rotation[i]) / kQuaternionScale;
      square += q[i] * q[i];
    }
    if (std::abs(std::sqrt(square) - 1) > kQuaternionLengthTolerance) return {};
    pose.R = rotation_of_quaternion(q, encoding.rotation);
    return pose;
  }
  std::array<double, 3> angles{};
  for (std::size_t i = 0; i < 3; ++i) {
    angles[i] =
        get_int32(rotation.subspan(2 * i), encoding.word_order) / angles_per_rad(encoding.angle);
  }
  pose.R = rotation_of(angles, encoding.rotation);
  return pose;
}

}  // namespace binpick::modbus
