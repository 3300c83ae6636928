#include "modbus/request.hpp"

#include "binpick/base/assert.hpp"
#include "modbus/register_map.hpp"

namespace binpick::modbus {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Limits of the protocol, in registers.
constexpr int kReadMax = 125;
constexpr int kWriteMax = 123;
constexpr int kReadWriteWriteMax = 121;

struct Range {
  int start, count;
};

int word_at(Bytes bytes, std::size_t at) {
  return bytes[at] << 8 | bytes[at + 1];
}

bool within(Range inner, int start, int count) {
  return inner.start >= start && inner.start + inner.count <= start + count;
}

bool readable(Range range) {
  return within(range, map::kCommandStart, map::kCommandCount) ||
         within(range, map::kAnswerStart, map::kAnswerCount);
}

bool writable(Range range) {
  return within(range, map::kCommandStart, map::kCommandCount);
}

RequestVerdict judge_read(Bytes pdu) {
  if (pdu.size() != 5) return {Exception::kIllegalValue};
  const Range range{word_at(pdu, 1), word_at(pdu, 3)};
  if (range.count < 1 || range.count > kReadMax) return {Exception::kIllegalValue};
  return {readable(range) ? Exception::kNone : Exception::kIllegalAddress};
}

RequestVerdict judge_write(Bytes pdu, Range range, std::size_t values_at, int count_max,
                           bool may_write) {
  const std::size_t value_bytes = pdu.size() - values_at;
  if (range.count < 1 || range.count > count_max ||
      value_bytes != 2 * static_cast<std::size_t>(range.count)) {
    return {Exception::kIllegalValue};
  }
  if (!writable(range)) return {Exception::kIllegalAddress};
  if (!may_write) return {Exception::kIllegalFunction};
  return {Exception::kNone, true};
}

RequestVerdict judge_write_one(Bytes pdu, bool may_write) {
  if (pdu.size() != 5) return {Exception::kIllegalValue};
  return judge_write(pdu, {word_at(pdu, 1), 1}, 3, 1, may_write);
}

RequestVerdict judge_write_many(Bytes pdu, bool may_write) {
  if (pdu.size() < 6 || pdu.size() != 6U + pdu[5]) return {Exception::kIllegalValue};
  return judge_write(pdu, {word_at(pdu, 1), word_at(pdu, 3)}, 6, kWriteMax, may_write);
}

RequestVerdict judge_read_write(Bytes pdu, bool may_write) {
  if (pdu.size() < 10 || pdu.size() != 10U + pdu[9]) return {Exception::kIllegalValue};
  const RequestVerdict read = judge_read(pdu.first(5));
  if (read.exception != Exception::kNone) return read;
  return judge_write(pdu, {word_at(pdu, 5), word_at(pdu, 7)}, 10, kReadWriteWriteMax, may_write);
}

}  // namespace

RequestVerdict judge_request(Bytes frame, std::uint8_t unit_id, bool may_write) {
  BINPICK_ASSERT(frame.size() > kMbapBytes && frame.size() <= kFrameBytesMax);
  const std::uint8_t unit = frame[kMbapBytes - 1];
  if (unit != unit_id && unit != 0 && unit != 0xFF) return {Exception::kTargetSilent};
  const Bytes pdu = frame.subspan(kMbapBytes);
  switch (static_cast<Function>(pdu[0])) {
    case Function::kReadHolding:
    case Function::kReadInput:
      return judge_read(pdu);
    case Function::kWriteOne:
      return judge_write_one(pdu, may_write);
    case Function::kWriteMany:
      return judge_write_many(pdu, may_write);
    case Function::kReadWriteMany:
      return judge_read_write(pdu, may_write);
  }
  return {Exception::kIllegalFunction};
}

ExceptionFrame exception_frame(Bytes request, Exception exception) {
  BINPICK_ASSERT(request.size() > kMbapBytes);
  const auto function = static_cast<std::uint8_t>(request[kMbapBytes] | 0x80U);
  return {request[0],
          request[1],
          0,
          0,
          0,
          3,
          request[kMbapBytes - 1],
          function,
          static_cast<std::uint8_t>(exception)};
}

}  // namespace binpick::modbus
