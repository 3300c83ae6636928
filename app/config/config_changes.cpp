// Names and values of keys, for documentation and for reloading.
#include <algorithm>
#include <cstdio>
#include <deque>

#include "config/config_file.hpp"
#include "config/config_keys.hpp"

namespace binpick::app {
namespace {

// Each key's value written out, so that two configurations can be compared key by key.
class KeyWriter final : public KeyVisitor {
 public:
  struct Written {
    Key key;
    std::string value;
  };
  std::vector<Written> keys;

  void flag(const Key& key, bool& value) override { add(key, value ? "true" : "false"); }
  void integer(const Key& key, int& value, Range<int>) override { add(key, std::to_string(value)); }
  void number(const Key& key, double& value, Range<double>) override { add(key, exact(value)); }
  void text(const Key& key, std::string& value) override { add(key, value); }
  void choice(const Key& key, int& value, std::span<const char* const> names) override {
    add(key, names[static_cast<std::size_t>(value)]);
  }
  void numbers(const Key& key, std::span<double> values, Range<double>) override {
    std::string all;
    for (const double value : values) all += exact(value) + ",";
    add(key, all);
  }
  void integers(const Key& key, std::vector<int>& values, Range<int>) override {
    std::string all;
    for (const int value : values) all += std::to_string(value) + ",";
    add(key, all);
  }
  void matrix(const Key& key, std::vector<double>& values, std::size_t, std::size_t) override {
    numbers(key, values, {});
  }
  void texts(const Key& key, std::vector<std::string>& values) override {
    std::string all;
    for (const std::string& value : values) all += value + '\0';
    add(key, all);
  }

 private:
  static std::string exact(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
  }
  void add(const Key& key, std::string value) { keys.push_back({key, std::move(value)}); }
};

template <class Part>
std::vector<KeyWriter::Written> written(Part part) {
  KeyWriter writer;
  visit_keys(part, writer);
  return writer.keys;
}

// A region has the size of the region, none that of the image.
bool region_fits(const RecipeConfig& recipe, const ReloadLimits& limits) {
  const double width = recipe.roi_px[2] > 0 ? recipe.roi_px[2] : limits.image_width;
  const double height = recipe.roi_px[3] > 0 ? recipe.roi_px[3] : limits.image_height;
  return width <= limits.roi_width && height <= limits.roi_height;
}

template <class Part>
void add_changes(const Part& running, const Part& wanted, const std::string& prefix, bool fits,
                 ConfigChanges& changes) {
  const auto a = written(running), b = written(wanted);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].value == b[i].value) continue;
    const Reload reload = a[i].key.reload;
    const bool live = reload == Reload::kLive || (reload == Reload::kIfItFits && fits);
    (live ? changes.live : changes.restart).push_back(prefix + a[i].key.path);
  }
}

// Collects the live values in a first visit and hands them out again in a second.
class LiveValues final : public KeyVisitor {
 public:
  void flag(const Key& key, bool& value) override { pass(key, flags_, value); }
  void integer(const Key& key, int& value, Range<int>) override { pass(key, integers_, value); }
  void number(const Key& key, double& value, Range<double>) override { pass(key, numbers_, value); }
  void text(const Key& key, std::string& value) override { pass(key, texts_, value); }
  void choice(const Key& key, int& value, std::span<const char* const>) override {
    pass(key, integers_, value);
  }
  void numbers(const Key& key, std::span<double> values, Range<double>) override {
    for (double& value : values) pass(key, numbers_, value);
  }
  void matrix(const Key& key, std::vector<double>& values, std::size_t, std::size_t) override {
    pass(key, lists_, values);
  }
  // Other lists are never live: they size memory.
  void integers(const Key&, std::vector<int>&, Range<int>) override {}
  void texts(const Key&, std::vector<std::string>&) override {}

  void hand_out() { collecting_ = false; }

 private:
  template <class T>
  void pass(const Key& key, std::deque<T>& values, T& value) {
    if (key.reload != Reload::kLive) return;
    if (collecting_) {
      values.push_back(value);
    } else {
      value = values.front();
      values.pop_front();
    }
  }

  bool collecting_ = true;
  std::deque<bool> flags_;
  std::deque<int> integers_;
  std::deque<double> numbers_;
  std::deque<std::vector<double>> lists_;
  std::deque<std::string> texts_;
};

template <class Part>
void copy_live(Part& running, Part wanted) {
  LiveValues values;
  visit_keys(wanted, values);
  values.hand_out();
  visit_keys(running, values);
}

template <class Part>
std::vector<std::string> names_of() {
  std::vector<std::string> names;
  for (const auto& key : written(Part{})) names.push_back(key.key.path);
  return names;
}

}  // namespace

ConfigChanges compare(const Config& running, const Config& wanted, const ReloadLimits& limits) {
  ConfigChanges changes;
  add_changes(running, wanted, "", false, changes);
  if (running.recipes.size() != wanted.recipes.size()) return changes;  // station.recipes says it
  for (std::size_t i = 0; i < running.recipes.size(); ++i) {
    const std::string prefix = "recipe " + std::to_string(running.recipes[i].number) + ": ";
    add_changes(running.recipes[i], wanted.recipes[i], prefix,
                region_fits(wanted.recipes[i], limits), changes);
  }
  return changes;
}

void take_live_values(Config& running, const Config& wanted, const ReloadLimits& limits) {
  copy_live(running, wanted);
  const auto same_number = [](const RecipeConfig& a, const RecipeConfig& b) {
    return a.number == b.number;
  };
  if (!std::equal(running.recipes.begin(), running.recipes.end(), wanted.recipes.begin(),
                  wanted.recipes.end(), same_number))
    return;
  for (std::size_t i = 0; i < running.recipes.size(); ++i) {
    copy_live(running.recipes[i], wanted.recipes[i]);
    if (region_fits(wanted.recipes[i], limits))
      running.recipes[i].roi_px = wanted.recipes[i].roi_px;
  }
}

std::vector<std::string> config_key_names() {
  return names_of<Config>();
}

std::vector<std::string> recipe_key_names() {
  return names_of<RecipeConfig>();
}

}  // namespace binpick::app
