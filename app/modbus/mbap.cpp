#include "modbus/mbap.hpp"

#include <cstring>

#include "binpick/base/assert.hpp"

namespace binpick::modbus {
namespace {

constexpr std::size_t kPrefixBytes = 6;  // transaction, protocol, length
// The length field counts unit id and request: at least a function code.
constexpr std::size_t kLengthMin = 2;
constexpr std::size_t kLengthMax = kFrameBytesMax - kPrefixBytes;

}  // namespace

std::span<std::uint8_t> FrameReader::space() {
  if (begin_ > 0) {
    std::memmove(bytes_.data(), bytes_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  return std::span(bytes_).subspan(end_);
}

void FrameReader::added(std::size_t bytes) {
  BINPICK_ASSERT(bytes <= bytes_.size() - end_);
  end_ += bytes;
}

FrameReader::Next FrameReader::peek() const {
  const auto rest = std::span(bytes_).subspan(begin_, end_ - begin_);
  if (rest.empty()) return {State::kEmpty, {}};
  // As early as it can be known: a stream of anything else is not waited for.
  for (std::size_t i = 2; i < 4 && i < rest.size(); ++i) {
    if (rest[i] != 0) return {State::kWrongProtocol, {}};
  }
  if (rest.size() < kPrefixBytes) return {State::kPartial, {}};
  const auto length = static_cast<std::size_t>(rest[4] << 8 | rest[5]);
  if (length < kLengthMin || length > kLengthMax) return {State::kWrongLength, {}};
  if (rest.size() < kPrefixBytes + length) return {State::kPartial, {}};
  return {State::kFrame, rest.first(kPrefixBytes + length)};
}

void FrameReader::take() {
  const Next next = peek();
  BINPICK_ASSERT(next.state == State::kFrame);
  begin_ += next.frame.size();
}

}  // namespace binpick::modbus
