// Angles are in rad wherever a name does not say otherwise.
#pragma once

#include <numbers>

namespace binpick {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180;  // in rad: 5 * kDegree is five degrees

}  // namespace binpick
