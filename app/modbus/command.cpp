#include "modbus/command.hpp"

#include <algorithm>
#include <iterator>

namespace binpick::modbus {
namespace {

using map::Cause;
using map::CommandCode;

constexpr std::size_t index_of(int address) {
  return static_cast<std::size_t>(address - map::kCommandStart);
}

bool is_known(std::uint16_t code) {
  return std::any_of(std::begin(map::kCommandCodeNames), std::end(map::kCommandCodeNames),
                     [&](const map::NamedValue& known) { return known.value == code; });
}

bool takes_frame(CommandCode code) {
  return code == CommandCode::kDetect || code == CommandCode::kCapture;
}

bool finds_parts(CommandCode code) {
  return code == CommandCode::kDetect || code == CommandCode::kProcess ||
         code == CommandCode::kFreeRunStart;
}

Cause judge(const Command& c, const CommandLimits& limits) {
  const bool uses_recipe = finds_parts(c.code) || takes_frame(c.code);
  if ((uses_recipe || c.code == CommandCode::kSelectRecipe) && c.recipe > limits.recipe_count) {
    return Cause::kRecipeUnknown;
  }
  if (c.code == CommandCode::kSelectRecipe && c.recipe == 0) return Cause::kRecipeUnknown;
  if (finds_parts(c.code) && c.picks_max > limits.picks_max) return Cause::kPicksMaxTooLarge;
  if (uses_recipe && c.deadline_ms != 0 && c.deadline_ms < limits.deadline_ms_min) {
    return Cause::kDeadlineTooShort;
  }
  if (c.code == CommandCode::kPage && c.page == 0) return Cause::kPageUnknown;
  if (takes_frame(c.code) && limits.flange_pose_needed && !c.T_base_flange) {
    return Cause::kFlangePoseInvalid;
  }
  return Cause::kDone;
}

}  // namespace

Command decode_command(const CommandRegisters& r, const CommandLimits& limits,
                       const Encoding& encoding) {
  Command command;
  command.sequence = r[index_of(map::kAddressCommandSequence)];
  const std::uint16_t code = r[index_of(map::kAddressCommandCode)];
  if (!is_known(code)) {
    command.refusal = Cause::kCommandUnknown;
    return command;
  }
  command.code = static_cast<CommandCode>(code);
  command.recipe = r[index_of(map::kAddressCommandRecipe)];
  command.picks_max = r[index_of(map::kAddressCommandPicksMax)];
  command.deadline_ms = r[index_of(map::kAddressCommandDeadline)];
  command.page = r[index_of(map::kAddressCommandPage)];
  if (limits.flange_pose_needed && takes_frame(command.code)) {
    command.T_base_flange =
        get_pose(std::span(r).subspan(index_of(map::kAddressFlangeX), kPoseWords), encoding);
  }
  command.refusal = judge(command, limits);
  return command;
}

void encode_command(const Command& c, const Encoding& encoding, CommandRegisters& r) {
  r[index_of(map::kAddressCommandCode)] = static_cast<std::uint16_t>(c.code);
  r[index_of(map::kAddressCommandRecipe)] = static_cast<std::uint16_t>(c.recipe);
  r[index_of(map::kAddressCommandPicksMax)] = static_cast<std::uint16_t>(c.picks_max);
  r[index_of(map::kAddressCommandDeadline)] = static_cast<std::uint16_t>(c.deadline_ms);
  r[index_of(map::kAddressCommandPage)] = static_cast<std::uint16_t>(c.page);
  put_pose(std::span(r).subspan(index_of(map::kAddressFlangeX), kPoseWords), encoding,
           c.T_base_flange.value_or(Pose{}));
  r[index_of(map::kAddressReserved)] = 0;
  r[index_of(map::kAddressCommandSequence)] = c.sequence;
}

}  // namespace binpick::modbus
