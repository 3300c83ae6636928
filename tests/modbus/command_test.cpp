#include "modbus/command.hpp"

#include <gtest/gtest.h>

#include "command_inbox.hpp"

namespace binpick::modbus {
namespace {

using map::Cause;
using map::CommandCode;

constexpr CommandLimits kLimits{.recipe_count = 3, .picks_max = 24, .deadline_ms_min = 20};

Cause refusal_of(Command command, const CommandLimits& limits = kLimits) {
  CommandRegisters registers{};
  encode_command(command, {}, registers);
  return decode_command(registers, limits, {}).refusal;
}

TEST(Command, ComesBackFromItsRegisters) {
  Command command;
  command.sequence = 7;
  command.code = CommandCode::kDetect;
  command.recipe = 2;
  command.picks_max = 12;
  command.deadline_ms = 500;
  command.T_base_flange = Pose{Mat3::Identity(), {100, -200, 300.5}};
  CommandLimits limits = kLimits;
  limits.flange_pose_needed = true;
  for (const auto& order : map::kWordOrderNames) {
    const Encoding encoding{.word_order = static_cast<map::WordOrder>(order.value)};
    CommandRegisters registers{};
    encode_command(command, encoding, registers);
    const Command back = decode_command(registers, limits, encoding);
    EXPECT_EQ(back.refusal, Cause::kDone);
    EXPECT_EQ(back.sequence, 7);
    EXPECT_EQ(back.code, CommandCode::kDetect);
    EXPECT_EQ(back.recipe, 2);
    EXPECT_EQ(back.picks_max, 12);
    EXPECT_EQ(back.deadline_ms, 500);
    ASSERT_TRUE(back.T_base_flange);
    EXPECT_TRUE(back.T_base_flange->t_mm.isApprox(Vec3(100, -200, 300.5)));
  }
}

TEST(Command, IsRefusedWithItsCause) {
  EXPECT_EQ(refusal_of({.code = static_cast<CommandCode>(99)}), Cause::kCommandUnknown);
  EXPECT_EQ(refusal_of({.code = CommandCode::kDetect, .recipe = 4}), Cause::kRecipeUnknown);
  EXPECT_EQ(refusal_of({.code = CommandCode::kSelectRecipe, .recipe = 0}), Cause::kRecipeUnknown);
  EXPECT_EQ(refusal_of({.code = CommandCode::kProcess, .picks_max = 25}), Cause::kPicksMaxTooLarge);
  EXPECT_EQ(refusal_of({.code = CommandCode::kDetect, .deadline_ms = 19}),
            Cause::kDeadlineTooShort);
  EXPECT_EQ(refusal_of({.code = CommandCode::kPage, .page = 0}), Cause::kPageUnknown);
}

TEST(Command, IsNotJudgedByParametersThatItDoesNotUse) {
  EXPECT_EQ(refusal_of({.code = CommandCode::kClearFault, .recipe = 9, .picks_max = 999}),
            Cause::kDone);
  EXPECT_EQ(refusal_of({.code = CommandCode::kNextPage, .deadline_ms = 1}), Cause::kDone);
  EXPECT_EQ(refusal_of({.code = CommandCode::kDetect}), Cause::kDone);
}

TEST(Command, NeedsAFlangePoseOnlyWhereTheSensorIsOnTheArm) {
  CommandLimits limits = kLimits;
  const Encoding encoding{.rotation = map::RotationConvention::kQuaternionXyzw};
  CommandRegisters registers{};
  registers[map::kAddressCommandCode] = static_cast<std::uint16_t>(CommandCode::kCapture);
  EXPECT_EQ(decode_command(registers, limits, encoding).refusal, Cause::kDone);
  limits.flange_pose_needed = true;
  EXPECT_EQ(decode_command(registers, limits, encoding).refusal, Cause::kFlangePoseInvalid);
  registers[map::kAddressFlangeRotation1 + 3] = 32767;  // w
  EXPECT_EQ(decode_command(registers, limits, encoding).refusal, Cause::kDone);
}

TEST(CommandBlock, StartsOnlyWhenTheSequenceChangesToANumber) {
  CommandBlock block;
  CommandRegisters registers{};
  EXPECT_FALSE(block.starts(registers));
  registers[map::kAddressCommandCode] = 1;
  EXPECT_FALSE(block.starts(registers));
  registers[map::kAddressCommandSequence] = 5;
  EXPECT_TRUE(block.starts(registers));
  EXPECT_FALSE(block.starts(registers));
  registers[map::kAddressPlcHeartbeat] = 9;
  EXPECT_FALSE(block.starts(registers));
  registers[map::kAddressCommandSequence] = 0;
  EXPECT_FALSE(block.starts(registers));
  registers[map::kAddressCommandSequence] = 5;
  EXPECT_TRUE(block.starts(registers));
}

TEST(CommandInbox, HandsOverTheNewestAndCountsWhatItReplaced) {
  CommandInbox inbox;
  TakenCommand command;
  EXPECT_FALSE(inbox.take(command));
  EXPECT_FALSE(inbox.wait(command, 1));
  for (std::int64_t i = 1; i <= 3; ++i) inbox.put({.registers = {}, .taken_ns = i});
  EXPECT_TRUE(inbox.wait(command, 0));
  EXPECT_EQ(command.taken_ns, 3);
  EXPECT_EQ(inbox.replaced_count(), 2U);
  EXPECT_FALSE(inbox.wait(command, 0));
}

}  // namespace
}  // namespace binpick::modbus
