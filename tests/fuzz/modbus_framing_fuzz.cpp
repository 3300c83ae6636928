// Bytes as a hostile client may send them, in pieces of any length: what comes back is always a
// well-formed answer to a well-formed frame, the answer block never changes, and only a whole write
// of a new command_sequence by who may write starts a command. Input: one byte of flags and piece
// lengths, then the stream. The entry is libFuzzer's; fuzz_driver.cpp runs it without libFuzzer.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "binpick/base/assert.hpp"
#include "modbus/command.hpp"
#include "modbus/mbap.hpp"
#include "modbus/responder.hpp"

namespace binpick::modbus {
namespace {

class Session {
 public:
  explicit Session(bool may_write) : may_write_(may_write) {
    PublishedAnswer answer;
    encode_answer({}, {}, answer.registers);
    answer.revision = ++revision();
    responder().show(answer, 0);
    CommandRegisters empty{};
    std::copy(responder().command_registers().begin(), responder().command_registers().end(),
              empty.begin());
    block_.starts(empty);
    before_ = empty;
  }

  // False when the stream is refused.
  bool feed(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
      const auto space = reader_.space();
      const std::size_t part = std::min(space.size(), bytes.size());
      BINPICK_ASSERT(part > 0);
      std::copy_n(bytes.begin(), part, space.begin());
      reader_.added(part);
      bytes = bytes.subspan(part);
      while (reader_.peek().state == FrameReader::State::kFrame) {
        answer(reader_.peek().frame);
        reader_.take();
      }
      const auto state = reader_.peek().state;
      if (state != FrameReader::State::kEmpty && state != FrameReader::State::kPartial)
        return false;
    }
    return true;
  }

 private:
  // Made once: a context and two sockets for each input would be all that is measured.
  static Responder& responder() {
    static Responder one{1, {}};
    return one;
  }
  static std::uint64_t& revision() {
    static std::uint64_t one = 0;
    return one;
  }

  void answer(std::span<const std::uint8_t> frame) {
    const auto reply = responder().reply(frame, may_write_);
    const auto bytes = reply.bytes;
    BINPICK_ASSERT(bytes.size() >= 9 && bytes.size() <= kFrameBytesMax);
    BINPICK_ASSERT(std::equal(bytes.begin(), bytes.begin() + 4, frame.begin()));
    BINPICK_ASSERT(static_cast<std::size_t>(bytes[4] << 8 | bytes[5]) == bytes.size() - 6);
    BINPICK_ASSERT(bytes[6] == frame[6]);
    const bool refused = reply.exception != Exception::kNone;
    BINPICK_ASSERT(bytes[7] == (refused ? frame[7] | 0x80 : frame[7]));
    BINPICK_ASSERT(reply.exception != Exception::kServerFailure);
    const auto now = responder().command_registers();
    const bool changed = !std::equal(now.begin(), now.end(), before_.begin());
    BINPICK_ASSERT(!changed || (reply.wrote && may_write_ && !refused));
    const bool starts = block_.starts(now);
    BINPICK_ASSERT(!starts || changed);
    std::copy(now.begin(), now.end(), before_.begin());
    check_answer_block();
  }

  void check_answer_block() {
    static constexpr std::uint8_t kReadAll[] = {
        0, 1, 0, 0, 0, 6, 1, 3, 0, map::kAnswerStart, 0, map::kAnswerCount};
    const auto read = responder().reply(kReadAll, false).bytes;
    BINPICK_ASSERT(read.size() == 9 + 2 * map::kAnswerCount);
    AnswerRegisters expected;
    encode_answer({}, {}, expected);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      BINPICK_ASSERT((read[9 + 2 * i] << 8 | read[10 + 2 * i]) == expected[i]);
    }
  }

  bool may_write_;
  FrameReader reader_;
  CommandBlock block_;
  CommandRegisters before_{};
};

}  // namespace
}  // namespace binpick::modbus

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  binpick::modbus::Session session((data[0] & 0x80U) != 0);
  const std::size_t piece = 1 + (data[0] & 0x7FU);
  const std::span stream(data + 1, size - 1);
  for (std::size_t at = 0; at < stream.size(); at += piece) {
    if (!session.feed(stream.subspan(at, std::min(piece, stream.size() - at)))) break;
  }
  return 0;
}
