#include "fault_board.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace binpick::sim {
namespace {

constexpr unsigned kAtBoth = kAtGigE | kAtUsb3;

constexpr FaultKind kFaultKinds[kFaultCount] = {
    {"loss", kAtGigE, 1, "P: each stream packet is lost with probability P, resent ones too"},
    {"reorder", kAtGigE, 1, "P: a packet changes places with the next"},
    {"duplicate", kAtGigE, 1, "P: a packet comes twice"},
    {"truncate", kAtGigE, 1, "P: a packet ends in the middle of its data"},
    {"corrupt", kAtGigE, 1, "P: a packet carries wrong data of the right size"},
    {"wrong-id", kAtGigE, 1, "P: a packet carries the number of another"},
    {"wrong-size", kAtGigE, 1, "P: a packet has 16 bytes too many"},
    {"lying-offset", kAtGigE, 1, "P: a frame's data lie beyond its end, as its packets say"},
    {"lying-size", kAtGigE, 1, "P: a frame's leader gives its first part twice the size"},
    {"lying-width", kAtBoth, 1, "P: a frame's leader gives twice the width"},
    {"lying-height", kAtBoth, 1, "P: a frame's leader gives twice the height"},
    {"short-payload", kAtUsb3, 1, "P: a frame ends after half of its data, the trailer follows"},
    {"wrong-trailer", kAtUsb3, 1, "P: what ends a frame is no trailer"},
    {"trailer-status", kAtUsb3, 1, "P: a frame's trailer says that data were discarded"},
    {"frozen", kAtBoth, 1, "0|1: answers nothing and sends nothing, as with the cable pulled"},
    {"hung", kAtUsb3, 1, "0|1: answers nothing; a reset of its port ends it"},
    {"stall", kAtUsb3, 1, "0|1: the stream's endpoint is halted; clearing the halt ends it"},
    {"refuse", kAtBoth, 1, "0|1: refuses control and every write"},
    {"stop-stream", kAtBoth, 1, "0|1: makes no frames; commands are answered"},
    {"slow", kAtBoth, 60000, "MS: each frame comes so much later"},
    {"idle", kAtBoth, 86400, "S: the first frame after a pause of S seconds or more is lost"},
};

}  // namespace

const FaultKind& fault_kind(Fault fault) {
  return kFaultKinds[fault];
}

std::string fault_help(FaultUse use) {
  std::string text;
  for (const FaultKind& kind : kFaultKinds) {
    if ((kind.use & use) == 0) continue;
    char line[160];
    std::snprintf(line, sizeof line, "  %-14s %s\n", kind.name, kind.help);
    text += line;
  }
  return text;
}

std::string FaultBoard::set(const std::string& name, const std::string& value) {
  for (int i = 0; i < kFaultCount; ++i) {
    if (name != kFaultKinds[i].name || (kFaultKinds[i].use & use_) == 0) continue;
    char* end = nullptr;
    const double number = std::strtod(value.c_str(), &end);
    const bool whole = !value.empty() && *end == '\0';
    if (!whole || !std::isfinite(number) || number < 0 || number > kFaultKinds[i].max) {
      char text[80];
      std::snprintf(text, sizeof text, "%s takes a number from 0 to %g", kFaultKinds[i].name,
                    kFaultKinds[i].max);
      return text;
    }
    values_[static_cast<std::size_t>(i)].store(number, std::memory_order_relaxed);
    return "";
  }
  return "there is no fault '" + name + "' (see --help)";
}

void FaultBoard::clear() {
  for (auto& value : values_) value.store(0, std::memory_order_relaxed);
}

std::string FaultBoard::text() const {
  std::string text;
  for (int i = 0; i < kFaultCount; ++i) {
    if (!on(static_cast<Fault>(i))) continue;
    char entry[64];
    std::snprintf(entry, sizeof entry, "%s%s=%g", text.empty() ? "" : " ", kFaultKinds[i].name,
                  value(static_cast<Fault>(i)));
    text += entry;
  }
  return text;
}

}  // namespace binpick::sim
