// Charts as inline SVG text, coloured by the style sheet of the page they stand in.
#pragma once

#include <string>
#include <vector>

#include "eval/reliability.hpp"
#include "eval/score.hpp"

namespace binpick::app {

// Precision over recall, both 0 to 1; the threshold of the best F1 is marked.
std::string precision_recall_svg(const PartScore& part);

// Share of right poses over their probability, both 0 to 1: a point with its interval for each bin
// that has a pose, beside the diagonal of a score that is what it says. Tooltips have the numbers.
std::string reliability_svg(const Reliability& reliability);

// One line of a chart: y over x, x ascending.
struct Curve {
  std::string name;
  std::vector<double> x, y;
};

// Lines over a common x axis, y from 0 to 1. Line i has the class "line-i", from nine on they
// repeat, and its name and values as tooltips.
std::string line_chart_svg(const std::vector<Curve>& curves, const std::string& x_axis,
                           const std::string& y_axis);
inline constexpr int kLineStyles = 9;

struct BarSegment {
  std::string name;
  double value = 0;
};

// One horizontal bar, its segments side by side; `full_scale` is the value of the whole width.
// Segment i has the class "stage-i" and its name and value as a tooltip.
std::string stacked_bar_svg(const std::vector<BarSegment>& segments, double full_scale,
                            const std::string& unit);

}  // namespace binpick::app
