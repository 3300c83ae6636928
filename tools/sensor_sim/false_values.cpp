#include "false_values.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "feature_map.hpp"

namespace binpick::sim {
namespace {

struct Feature {
  const char* name;
  std::uint64_t address;
  bool is_float;
};

constexpr Feature kFeatures[] = {
    {"Width", kWidth, false},
    {"Height", kHeight, false},
    {"PayloadSize", kPayloadSize, false},
    {"Scan3dOutputMode", kOutputMode, false},
    {"Scan3dDistanceUnit", kDistanceUnit, false},
    {"Scan3dCoordinateScale", kCoordinateScale + 8 * kCoordinateC, true},
    {"Scan3dCoordinateOffset", kCoordinateOffset + 8 * kCoordinateC, true},
    {"Scan3dInvalidDataValue", kInvalidDataValue + 8 * kCoordinateC, true},
    {"Scan3dFocalLength", kFocalLength, true},
    {"Scan3dAspectRatio", kAspectRatio, true},
    {"Scan3dPrincipalPointU", kPrincipalPointU, true},
    {"Scan3dPrincipalPointV", kPrincipalPointV, true},
    {"Scan3dBaseline", kBaseline, true},
};

}  // namespace

std::string FalseValues::names() {
  std::string text;
  for (const Feature& feature : kFeatures) text += std::string("  ") + feature.name + "\n";
  return text;
}

std::string FalseValues::set(const std::string& name, const std::string& value) {
  const auto feature = std::find_if(std::begin(kFeatures), std::end(kFeatures),
                                    [&](const Feature& f) { return name == f.name; });
  if (feature == std::end(kFeatures)) return "there is no false value for a feature " + name;
  char* end = nullptr;
  const double number = std::strtod(value.c_str(), &end);
  if (value.empty() || *end != '\0') return "'" + value + "' is not a number";
  const bool whole = number >= 0 && number <= std::numeric_limits<std::uint32_t>::max() &&
                     number == static_cast<double>(static_cast<std::uint32_t>(number));
  if (!feature->is_float && !whole) return name + " takes a whole number of 32 bits";
  std::vector<std::uint8_t> bytes(feature->is_float ? 8 : 4);
  if (feature->is_float) {
    put(bytes.data(), bits_of(number), order_);
  } else {
    put(bytes.data(), static_cast<std::uint32_t>(number), order_);
  }
  values_[feature->address] = bytes;
  return "";
}

void FalseValues::apply(std::uint64_t address, std::span<std::uint8_t> bytes) const {
  const std::uint64_t end = address + bytes.size();
  for (const auto& [at, value] : values_) {
    const std::uint64_t first = std::max(at, address), last = std::min(at + value.size(), end);
    for (std::uint64_t i = first; i < last; ++i) bytes[i - address] = value[i - at];
  }
}

}  // namespace binpick::sim
