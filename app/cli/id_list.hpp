// Lists of numbers on the command line: "1,2,5-7".
#pragma once

#include <set>
#include <string>

namespace binpick::app {

// Throws CLI::ValidationError naming `option`; an empty text is an empty set.
std::set<int> parse_id_list(const std::string& option, const std::string& text);

}  // namespace binpick::app
