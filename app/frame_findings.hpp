// What people, scripts and the PLC read about the findings of a frame check.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "binpick/check/frame_check.hpp"
#include "fixed_text.hpp"

namespace binpick::app {

const char* finding_name(FindingCode code);  // snake_case, as written to JSON

// The bit of the register no_pick_reasons that tells the finding.
std::uint16_t no_pick_reason_of(FindingCode code);

// What is wrong, in one sentence; `part` names the model that it is about. Allocates nothing.
void write_finding(const Finding& finding, const char* part, FixedText& text);
// What to do about it, in one sentence. Allocates nothing.
void write_advice(const Finding& finding, FixedText& text);

// The names of models, by their index.
using PartName = std::function<std::string(int)>;

// Both sentences.
std::string finding_text(const Finding& finding, const PartName& name);

// Of many frames: each kind of finding once.
class FindingsTold {
 public:
  // The sentences of those that were not told before.
  std::vector<std::string> fresh(const FrameFindings& findings, const PartName& name = {});

 private:
  std::set<std::pair<FindingCode, int>> told_;
};

// Code, severity, numbers by name, and both sentences of each.
nlohmann::ordered_json to_json(const FrameFindings& findings, const PartName& name);

}  // namespace binpick::app
