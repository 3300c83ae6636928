// A table for the console: the first column is aligned left, the others right.
#pragma once

#include <string>
#include <vector>

namespace binpick::app {

class TextTable {
 public:
  // The first row is the heading.
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace binpick::app
