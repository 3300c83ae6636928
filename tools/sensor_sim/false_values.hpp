// Features that tell the host something else than what the sensor does: hostile values, such as a
// scale of zero or a width that no memory holds. Only what is read changes, not the frames.
// Thread: one at a time; its owner locks.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "byte_order.hpp"

namespace binpick::sim {

class FalseValues {
 public:
  explicit FalseValues(ByteOrder order) : order_(order) {}

  // A feature's name as in the GenICam description (of the depth axis, where there are several) and
  // a number; "nan" and "inf" for floats. "" when done, else what is wrong with it.
  std::string set(const std::string& feature, const std::string& value);
  void clear() { values_.clear(); }
  bool empty() const { return values_.empty(); }

  // Puts the false bytes over those that were read at `address`.
  void apply(std::uint64_t address, std::span<std::uint8_t> bytes) const;

  // The features that it knows, for --help.
  static std::string names();

 private:
  ByteOrder order_;
  std::map<std::uint64_t, std::vector<std::uint8_t>> values_;  // by address
};

}  // namespace binpick::sim
