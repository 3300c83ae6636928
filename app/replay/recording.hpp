// A recording as the station's recorder writes it, read back. Every fault is a SetupError that
// names the file. Set-up only.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "modbus/answer.hpp"
#include "modbus/command.hpp"

namespace binpick::app {

// An order with its answer; most are cycles.
struct RecordedCycle {
  std::uint64_t cycle = 0;   // its own, or the one before it
  std::uint64_t record = 0;  // counts since the station's start, from 1; 0: it does not say
  std::string order;         // its name
  int recipe_selected = 0;   // when it had been carried out; 0: it does not say
  modbus::map::Cause cause = modbus::map::Cause::kNoResult;
  std::optional<int> image;  // of scene 1; none: the cycle had no frame
  modbus::CommandRegisters command{};
  modbus::AnswerRegisters answer{};
};

struct Recording {
  std::string folder;
  std::vector<RecordedCycle> cycles;
  // A line without its end: the station was cut off while it wrote.
  bool cut_off = false;
  struct Model {
    int recipe = 0;  // from 1, as the configuration lists them
    std::string path;
    std::uint64_t hash = 0;
  };
  std::vector<Model> models;
};

Recording load_recording(const std::string& folder);

// The configuration that it was made with. Models are looked for where they were, and where they
// are no longer by their names in `models_folder` (empty: not). Throws ConfigError too.
Config recorded_config(const Recording& recording, const std::string& models_folder);

}  // namespace binpick::app
