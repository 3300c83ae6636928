// Charts as inline SVG text, coloured by the style sheet of the page they stand in.
#pragma once

#include <string>
#include <vector>

#include "eval/score.hpp"

namespace binpick::app {

// Precision over recall, both 0 to 1; the threshold of the best F1 is marked.
std::string precision_recall_svg(const PartScore& part);

struct BarSegment {
  std::string name;
  double value = 0;
};

// One horizontal bar, its segments side by side; `full_scale` is the value of the whole width.
// Segment i has the class "stage-i" and its name and value as a tooltip.
std::string stacked_bar_svg(const std::vector<BarSegment>& segments, double full_scale,
                            const std::string& unit);

}  // namespace binpick::app
