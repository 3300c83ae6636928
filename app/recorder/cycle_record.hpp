// What is kept of an order, a whole cycle or a page that was turned: enough to carry it out again
// and to compare. Borrowed by the recorder for the call; the names are literals.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "binpick/frame/frame.hpp"

namespace binpick::app {

struct RecordedTime {
  const char* name = "";
  double ms = 0;
};

struct CycleRecord {
  std::uint64_t cycle = 0;
  std::int64_t unix_ns = 0;  // of the answer
  int cause = 0;
  const char* cause_name = "";
  const char* order_name = "";
  int recipe_selected = 0;  // when it had been carried out
  bool fault = false;
  std::span<const std::uint16_t> command, answer;  // registers, as they were and as published
  std::span<const RecordedTime> times;
  // Nothing: the cycle had no frame. Kept without loss where it has a scale (quantize_depth).
  const Frame* frame = nullptr;
};

// What the cycles were made with; written beside them.
struct RecordedFile {
  std::string name;  // relative, without ".."
  std::string text;
};
struct RecordedModel {
  int recipe = 0;  // which of the recipe files, from 1, looks for it
  std::string path;
  std::uint64_t hash = 0;
};
struct RecordedConfiguration {
  std::string program;  // name and version
  std::vector<RecordedFile> files;
  std::vector<RecordedModel> models;
};

}  // namespace binpick::app
