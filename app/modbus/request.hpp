// Judges a whole frame before libmodbus sees it. libmodbus checks neither unit id nor lengths,
// reads beyond short writes, and sleeps half a second on illegal counts; so only requests that are
// right in every byte go there, and the rest is answered from here. No sockets. Thread-safe: no
// state.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "modbus/mbap.hpp"

namespace binpick::modbus {

enum class Exception : std::uint8_t {
  kNone = 0,
  kIllegalFunction = 1,  // not 3, 4, 6, 16 or 23; or a write by who may not write
  kIllegalAddress = 2,   // unknown, or read-only and to be written
  kIllegalValue = 3,     // counts and lengths that contradict each other or the protocol
  kServerFailure = 4,    // libmodbus gave no answer
  kTargetSilent = 11,    // unit id of another device
};

enum class Function : std::uint8_t {
  kReadHolding = 3,
  kReadInput = 4,
  kWriteOne = 6,
  kWriteMany = 16,
  kReadWriteMany = 23,
};

struct RequestVerdict {
  Exception exception = Exception::kNone;
  bool writes = false;
};

// `unit_id` is ours; 0 and 255 are accepted too, as the protocol's guide for TCP asks.
RequestVerdict judge_request(std::span<const std::uint8_t> frame, std::uint8_t unit_id,
                             bool may_write);

inline constexpr std::size_t kExceptionBytes = 9;
using ExceptionFrame = std::array<std::uint8_t, kExceptionBytes>;
ExceptionFrame exception_frame(std::span<const std::uint8_t> request, Exception exception);

}  // namespace binpick::modbus
