#include "cli/arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <span>
#include <vector>

#include "cli/model_summary.hpp"

namespace binpick::app {
namespace {

constexpr int kPixelsMax = 1000000;  // beyond any sensor; sums of two still fit an int

[[noreturn]] void refuse(const std::string& option, const std::string& text,
                         const std::string& expected) {
  throw CLI::ValidationError(option, "'" + text + "': " + expected);
}

// The numbers between separators; empty when any is not wholly a number.
template <class Number>
std::vector<Number> split_numbers(const std::string& text, char separator) {
  std::vector<Number> numbers;
  const char* p = text.data();
  const char* const end = p + text.size();
  for (;;) {
    Number number{};
    const auto [stop, error] = std::from_chars(p, end, number);
    if (error != std::errc()) return {};
    numbers.push_back(number);
    if (stop == end) return numbers;
    if (*stop != separator) return {};
    p = stop + 1;
  }
}

std::string list_of(std::span<const char* const> names) {
  std::string list = names[0];
  for (std::size_t i = 1; i < names.size(); ++i)
    list += (i + 1 < names.size() ? ", " : " or ") + std::string(names[i]);
  return list;
}

// The position of a text among names.
int parse_choice(const std::string& option, const std::string& text,
                 std::span<const char* const> names) {
  const auto at = std::find(names.begin(), names.end(), text);
  if (at == names.end()) refuse(option, text, "expected " + list_of(names));
  return static_cast<int>(at - names.begin());
}

}  // namespace

std::pair<double, double> parse_range(const std::string& option, const std::string& text) {
  const std::vector<double> v = split_numbers<double>(text, ':');
  const bool right = v.size() == 2 && std::isfinite(v[1]) && v[0] > 0 && v[0] < v[1];
  if (!right) refuse(option, text, "expected MIN:MAX, two positive numbers, the smaller one first");
  return {v[0], v[1]};
}

Roi parse_roi(const std::string& option, const std::string& text) {
  const std::vector<int> v = split_numbers<int>(text, ',');
  const auto absurd = [](int pixels) { return std::abs(pixels) > kPixelsMax; };
  if (v.size() != 4 || v[2] <= 0 || v[3] <= 0 || std::any_of(v.begin(), v.end(), absurd)) {
    refuse(option, text, "expected x,y,width,height: four whole numbers, a positive size");
  }
  return {v[0], v[1], v[2], v[3]};
}

drivers::FrameId parse_frame_id(const std::string& option, const std::string& text) {
  const std::vector<int> v = split_numbers<int>(text, '/');
  if (v.size() != 2 || v[0] < 0 || v[1] < 0) {
    refuse(option, text, "expected SCENE/IMAGE, two whole numbers");
  }
  return {v[0], v[1]};
}

Isa parse_isa(const std::string& option, const std::string& text) {
  Isa isa = Isa::kBest;
  if (!isa_from_name(text, isa)) {
    refuse(option, text, "expected best, scalar, sse4, avx2 or avx512");
  }
  if (!isa_supported(isa)) refuse(option, text, "this machine cannot run it");
  return isa;
}

Modality parse_modality(const std::string& option, const std::string& text) {
  return static_cast<Modality>(parse_choice(option, text, kModalityNames));
}

NearSymmetry parse_near_symmetry(const std::string& option, const std::string& text) {
  return static_cast<NearSymmetry>(parse_choice(option, text, kNearSymmetryNames));
}

std::string modality_list() {
  return list_of(kModalityNames);
}

std::string near_symmetry_list() {
  return list_of(kNearSymmetryNames);
}

train::LengthUnit parse_unit(const std::string& option, const std::string& text) {
  using Unit = train::LengthUnit;
  if (text.empty()) return Unit::kOfFile;
  for (const Unit unit : {Unit::kMillimetre, Unit::kMetre, Unit::kInch, Unit::kCentimetre,
                          Unit::kFoot, Unit::kMicrometre}) {
    if (text == unit_name(static_cast<int>(unit))) return unit;
  }
  refuse(option, text, "expected mm, m, inch, cm, ft or um");
}

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace binpick::app
