#include "daemon/answer_of_result.hpp"

#include <algorithm>

namespace binpick::app {
namespace {

namespace map = modbus::map;

// Parts of which less can be seen are flagged.
constexpr double kPartlyHiddenBelow = 0.9;
constexpr std::int64_t kNsPerMs = 1'000'000;

std::uint16_t held(int value) {
  return static_cast<std::uint16_t>(std::clamp(value, 0, 65535));
}

std::uint16_t flags_of(const Pick& pick) {
  using Flag = map::PickFlagsBit;
  const auto bit = [](bool set, Flag which) { return set ? static_cast<int>(which) : 0; };
  return static_cast<std::uint16_t>(
      bit(pick.visible_fraction < kPartlyHiddenBelow, Flag::kPartlyHidden) |
      bit(pick.symmetric, Flag::kSymmetric) | bit(pick.pose_ambiguous, Flag::kPoseAmbiguous));
}

void fill_page(const CycleResult& result, modbus::AnswerSnapshot& answer) {
  const auto first = static_cast<std::size_t>(std::max(0, result.page - 1)) * map::kPicksPerPage;
  answer.page_pick_count = 0;
  for (std::size_t i = first; i < result.picks.size(); ++i) {
    if (answer.page_pick_count == map::kPicksPerPage) break;
    const Pick& pick = result.picks[i];
    answer.page_picks[static_cast<std::size_t>(answer.page_pick_count++)] = {
        .T_ref_part = pick.T_ref_pick,
        .score = pick.score,
        .visible = pick.visible_fraction,
        .recipe = held(result.recipe),
        .flags = flags_of(pick)};
  }
}

}  // namespace

void fill_answer(const CycleResult& result, modbus::AnswerSnapshot& answer) {
  const bool from_plc = result.order.source == OrderSource::kPlc;
  answer.result_command =
      from_plc ? static_cast<std::uint16_t>(result.order.sequence) : std::uint16_t{0};
  answer.cause = result.cause;
  answer.no_pick_reasons = result.no_pick_reasons;
  answer.detections = held(result.detections);
  answer.picks = held(static_cast<int>(result.picks.size()));
  answer.page = held(result.page);
  answer.recipe = held(result.recipe);
  answer.cycle_number = static_cast<std::uint32_t>(result.cycle);
  answer.capture_unix_ms = result.capture_unix_ns / kNsPerMs;
  answer.cycle_time_ms = static_cast<std::int64_t>(result.times.total_ms + 0.5);
  fill_page(result, answer);
}

modbus::CommandRegisters command_registers(const Order& order, const modbus::Encoding& encoding) {
  if (order.source == OrderSource::kPlc) return order.written;
  modbus::Command command;
  command.sequence = static_cast<std::uint16_t>(order.sequence);
  command.code = order.code;
  command.recipe = order.recipe;
  command.picks_max = order.picks_max;
  command.deadline_ms = order.deadline_ms;
  command.page = order.page;
  if (order.has_flange_pose) command.T_base_flange = order.T_base_flange;
  modbus::CommandRegisters registers{};
  modbus::encode_command(command, encoding, registers);
  return registers;
}

Order order_of_command(const modbus::CommandRegisters& registers, const modbus::Encoding& encoding,
                       bool flange_needed, std::int64_t received_ns) {
  // Recipes and limits are judged where the order is carried out, by the same rules for all who
  // order.
  modbus::CommandLimits limits;
  limits.recipe_count = limits.picks_max = 0xFFFF;
  limits.flange_pose_needed = flange_needed;
  const modbus::Command command = modbus::decode_command(registers, limits, encoding);
  Order order;
  order.code = command.code;
  order.source = OrderSource::kPlc;
  order.sequence = command.sequence;
  order.recipe = command.recipe;
  order.picks_max = command.picks_max;
  order.deadline_ms = command.deadline_ms;
  order.page = command.page;
  order.has_flange_pose = command.T_base_flange.has_value();
  order.T_base_flange = command.T_base_flange.value_or(Pose{});
  order.received_ns = received_ns;
  order.refusal = command.refusal;
  order.written = registers;
  return order;
}

}  // namespace binpick::app
