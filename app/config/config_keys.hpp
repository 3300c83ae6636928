// The one list of the configuration's keys. Whoever reads, checks, documents or compares a
// configuration visits it. Set-up only.
#pragma once

#include <limits>
#include <span>

#include "config/config.hpp"

namespace binpick::app {

// What it takes for a changed value to have an effect.
enum class Reload {
  kLive,
  kIfItFits,  // live where the memory taken at start suffices
  kRestart,
};

struct Key {
  const char* path;  // "station.deadline_ms"
  Reload reload = Reload::kRestart;
};

template <class T>
struct Range {
  T min = std::numeric_limits<T>::lowest(), max = std::numeric_limits<T>::max();
};

class KeyVisitor {
 public:
  virtual ~KeyVisitor() = default;
  virtual void flag(const Key& key, bool& value) = 0;
  virtual void integer(const Key& key, int& value, Range<int> range) = 0;
  virtual void number(const Key& key, double& value, Range<double> range) = 0;
  virtual void text(const Key& key, std::string& value) = 0;
  // `value` is an index into names.
  virtual void choice(const Key& key, int& value, std::span<const char* const> names) = 0;
  // Exactly as many as there are.
  virtual void numbers(const Key& key, std::span<double> values, Range<double> range) = 0;
  virtual void integers(const Key& key, std::vector<int>& values, Range<int> range) = 0;
  virtual void texts(const Key& key, std::vector<std::string>& values) = 0;
};

// Of the main file; not of its recipes.
void visit_keys(Config& config, KeyVisitor& visitor);
// Of one recipe file.
void visit_keys(RecipeConfig& recipe, KeyVisitor& visitor);

}  // namespace binpick::app
