#include "daemon/control_text.hpp"

#include <charconv>
#include <nlohmann/json.hpp>
#include <vector>

#include "frame_findings.hpp"

namespace binpick::app {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (!line.empty()) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) break;
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
  return words;
}

bool read_number(std::string_view text, int& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value >= 0 && value <= 65535;
}

ControlRequest wrong(std::string fault) {
  ControlRequest request;
  request.fault = std::move(fault);
  return request;
}

ControlRequest order(OrderCode code) {
  ControlRequest request;
  request.kind = ControlRequest::Kind::kOrder;
  request.order.code = code;
  return request;
}

// detect, capture, process: key=value words.
ControlRequest cycle_order(OrderCode code, std::span<const std::string_view> words) {
  ControlRequest request = order(code);
  for (const std::string_view word : words) {
    const std::size_t equals = word.find('=');
    const std::string_view key = word.substr(0, equals);
    int* value = key == "recipe"        ? &request.order.recipe
                 : key == "picks"       ? &request.order.picks_max
                 : key == "deadline_ms" ? &request.order.deadline_ms
                                        : nullptr;
    if (value == nullptr || equals == std::string_view::npos ||
        !read_number(word.substr(equals + 1), *value))
      return wrong("'" + std::string(word) +
                   "' is none of recipe=N, picks=N, deadline_ms=N with N from 0 to 65535");
  }
  return request;
}

ControlRequest numbered_order(OrderCode code, int Order::*field,
                              std::span<const std::string_view> words) {
  ControlRequest request = order(code);
  if (words.size() != 1 || !read_number(words[0], request.order.*field))
    return wrong("a number from 0 to 65535 is expected");
  return request;
}

Json matrix_json(const Pose& T) {
  Json rows = Json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({T.R(r, 0), T.R(r, 1), T.R(r, 2), T.t_mm(r)});
  return rows;
}

Json times_json(const CycleTimes& t) {
  return {{"wait", t.wait_ms},
          {"grab", t.grab_ms},
          {"detect", t.detect_ms},
          {"rank", t.rank_ms},
          {"total", t.total_ms}};
}

}  // namespace

const char* const kControlHelp =
    "detect|capture|process [recipe=N] [picks=N] [deadline_ms=N], recipe N, page N, next_page, "
    "clear_fault, free_run on|off, flush, record, status";

ControlRequest parse_control_line(std::string_view line) {
  const std::vector<std::string_view> words = words_of(line);
  if (words.empty()) return wrong("an empty line");
  const std::span<const std::string_view> rest = std::span(words).subspan(1);
  const std::string_view verb = words[0];
  if (verb == "detect") return cycle_order(OrderCode::kDetect, rest);
  if (verb == "capture") return cycle_order(OrderCode::kCapture, rest);
  if (verb == "process") return cycle_order(OrderCode::kProcess, rest);
  if (verb == "recipe") return numbered_order(OrderCode::kSelectRecipe, &Order::recipe, rest);
  if (verb == "page") return numbered_order(OrderCode::kPage, &Order::page, rest);
  if (verb == "free_run") {
    if (rest.size() != 1 || (rest[0] != "on" && rest[0] != "off"))
      return wrong("free_run on, or free_run off");
    return order(rest[0] == "on" ? OrderCode::kFreeRunStart : OrderCode::kFreeRunStop);
  }
  if (!rest.empty()) return wrong("'" + std::string(rest[0]) + "' is not expected there");
  if (verb == "next_page") return order(OrderCode::kNextPage);
  if (verb == "clear_fault") return order(OrderCode::kClearFault);
  if (verb == "flush") return order(OrderCode::kFlush);
  ControlRequest request;
  if (verb == "status") {
    request.kind = ControlRequest::Kind::kStatus;
  } else if (verb == "record") {
    request.kind = ControlRequest::Kind::kRecord;
  } else if (verb == "help") {
    request.kind = ControlRequest::Kind::kHelp;
  } else {
    return wrong("'" + std::string(verb) + "' is none of: " + kControlHelp);
  }
  return request;
}

std::string result_json(const CycleResult& r) {
  Json json = {{"ok", is_done(r.cause)},
               {"order", order_name(r.order.code)},
               {"cycle", r.cycle},
               {"cause", static_cast<int>(r.cause)},
               {"cause_name", cause_name(r.cause)},
               {"no_pick_reasons", r.no_pick_reasons},
               {"late", r.late},
               {"recipe", r.recipe},
               {"frame_sequence", r.frame_sequence},
               {"capture_unix_ns", r.capture_unix_ns},
               {"detections", r.detections},
               {"page", r.page},
               {"pose_frame", r.pose_frame == PoseFrame::kBase ? "base" : "camera"}};
  if (r.error.code != ErrorCode::kNone) {
    std::array<char, 160> memory;
    FixedText text(memory);
    write_error(r.error, text);
    json["error"] = std::string(text.text());
  }
  json["times_ms"] = times_json(r.times);
  for (int i = 0; i < kStageCount; ++i)
    json["stages_ms"][stage_name(static_cast<Stage>(i))] = r.stage_ms[static_cast<std::size_t>(i)];
  for (int i = 0; i < kDropReasonCount; ++i)
    json["dropped"][drop_reason_name(static_cast<DropReason>(i))] =
        r.dropped[static_cast<std::size_t>(i)];
  json["diagnostics"] =
      to_json(r.findings, [&](int) { return "the part of recipe " + std::to_string(r.recipe); });
  json["picks"] = Json::array();
  for (const Pick& pick : r.picks) {
    json["picks"].push_back({{"T_ref_pick", matrix_json(pick.T_ref_pick)},
                             {"score", pick.score},
                             {"symmetric", pick.symmetric},
                             {"pose_ambiguous", pick.pose_ambiguous},
                             {"visible_fraction", pick.visible_fraction},
                             {"depth_residual_mm", pick.depth_residual_mm},
                             {"model", pick.model}});
  }
  return json.dump();
}

std::string status_json(const StationStatus& status, const char* sensor_state,
                        const CycleResult& last) {
  Json json = {{"ok", true},
               {"state", station_state_name(status.state)},
               {"busy", status.busy},
               {"recipe", status.recipe},
               {"free_running", status.free_running},
               {"plc_heartbeat_lost", status.plc_lost},
               {"sensor", sensor_state}};
  if (last.cycle > 0)
    json["last"] = {{"cycle", last.cycle},
                    {"cause_name", cause_name(last.cause)},
                    {"picks", last.picks.size()},
                    {"times_ms", times_json(last.times)}};
  return json.dump();
}

std::string refusal_json(Cause cause, std::string_view fault) {
  return Json{{"ok", false},
              {"cause", static_cast<int>(cause)},
              {"cause_name", cause_name(cause)},
              {"fault", fault}}
      .dump();
}

std::string fault_json(std::string_view fault) {
  return Json{{"ok", false}, {"fault", fault}}.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace binpick::app
