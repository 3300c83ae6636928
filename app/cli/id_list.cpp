#include "cli/id_list.hpp"

#include <CLI/Error.hpp>
#include <charconv>
#include <sstream>

namespace binpick::app {
namespace {

constexpr int kIdMax = 999999;  // six digits name a scene, an image and an object

bool parse_range(const std::string& text, int& first, int& last) {
  const char* end = text.data() + text.size();
  auto [stop, error] = std::from_chars(text.data(), end, first);
  if (error != std::errc()) return false;
  last = first;
  if (stop != end) {
    if (*stop != '-') return false;
    const auto second = std::from_chars(stop + 1, end, last);
    if (second.ec != std::errc() || second.ptr != end) return false;
  }
  return 0 <= first && first <= last && last <= kIdMax;
}

}  // namespace

std::set<int> parse_id_list(const std::string& option, const std::string& text) {
  std::set<int> ids;
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, ',');) {
    int first = 0, last = 0;
    if (!parse_range(item, first, last)) {
      throw CLI::ValidationError(option, "\"" + item + "\" is not a number or a range such as 5-7");
    }
    for (int id = first; id <= last; ++id) ids.insert(id);
  }
  return ids;
}

}  // namespace binpick::app
