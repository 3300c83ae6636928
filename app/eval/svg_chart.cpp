#include "eval/svg_chart.hpp"

#include <cstdio>
#include <set>

#include "eval/html_text.hpp"

namespace binpick::app {
namespace {

// The plot's square in the drawing's units; ticks and titles stand outside.
constexpr double kLeft = 44, kTop = 12, kSide = 220;
constexpr std::size_t kTicksMax = 10, kMarksMax = 20;

double x_of(double recall) {
  return kLeft + kSide * recall;
}
double y_of(double precision) {
  return kTop + kSide * (1 - precision);
}

// With its tick.
std::string horizontal_line(double y) {
  return "<line class='grid' x1='" + fixed_digits(x_of(0), 1) + "' y1='" +
         fixed_digits(y_of(y), 1) + "' x2='" + fixed_digits(x_of(1), 1) + "' y2='" +
         fixed_digits(y_of(y), 1) + "'/><text class='tick' text-anchor='end' x='" +
         fixed_digits(x_of(0) - 6, 1) + "' y='" + fixed_digits(y_of(y) + 4, 1) + "'>" +
         fixed_digits(y, 1) + "</text>";
}

std::string axis_titles(const std::string& x_axis, const std::string& y_axis) {
  return "<text class='axis' text-anchor='middle' x='" + fixed_digits(x_of(0.5), 1) + "' y='" +
         fixed_digits(y_of(0) + 32, 1) + "'>" + escape_html(x_axis) +
         "</text><text class='axis' text-anchor='middle' transform='translate(11 " +
         fixed_digits(y_of(0.5), 1) + ") rotate(-90)'>" + escape_html(y_axis) + "</text>";
}

// Of a chart with both axes from 0 to 1.
std::string grid(const std::string& x_axis, const std::string& y_axis) {
  std::string svg;
  for (int i = 0; i <= 5; ++i) {
    const double v = 0.2 * i;
    const std::string tick = fixed_digits(v, 1);
    svg += "<line class='grid' x1='" + fixed_digits(x_of(v), 1) + "' y1='" +
           fixed_digits(y_of(0), 1) + "' x2='" + fixed_digits(x_of(v), 1) + "' y2='" +
           fixed_digits(y_of(1), 1) + "'/>";
    svg += horizontal_line(v);
    svg += "<text class='tick' text-anchor='middle' x='" + fixed_digits(x_of(v), 1) + "' y='" +
           fixed_digits(y_of(0) + 15, 1) + "'>" + tick + "</text>";
  }
  svg += axis_titles(x_axis, y_axis);
  return svg;
}

}  // namespace

std::string precision_recall_svg(const PartScore& part) {
  std::string svg =
      "<svg class='chart' viewBox='0 0 280 272' role='img' aria-label='precision over recall of " +
      std::string("object ") + std::to_string(part.obj_id) + "'>" + grid("recall", "precision");
  if (!part.curve.empty()) {
    svg += "<polyline class='curve' points='";
    for (const CurvePoint& p : part.curve) {
      svg += fixed_digits(x_of(p.recall), 1) + "," + fixed_digits(y_of(p.precision), 1) + " ";
    }
    svg += "'/>";
  }
  if (part.best.threshold) {
    const double x = x_of(part.best.recall), y = y_of(part.best.precision);
    svg += "<circle class='best' r='4.5' cx='" + fixed_digits(x, 1) + "' cy='" +
           fixed_digits(y, 1) + "'/>";
  }
  return svg + "</svg>";
}

std::string reliability_svg(const Reliability& reliability) {
  std::string svg = "<svg class='chart' viewBox='0 0 280 272' role='img' aria-label='" +
                    escape_html("share of right poses over probability, " + reliability.name) +
                    "'>" + grid("probability", "share right") + "<line class='diagonal' x1='" +
                    fixed_digits(x_of(0), 1) + "' y1='" + fixed_digits(y_of(0), 1) + "' x2='" +
                    fixed_digits(x_of(1), 1) + "' y2='" + fixed_digits(y_of(1), 1) + "'/>";
  for (const ReliabilityBin& bin : reliability.bins) {
    const RightShare& seen = bin.seen;
    if (seen.count == 0) continue;
    const std::string x = fixed_digits(x_of(bin.probability), 1);
    svg += "<line class='interval' x1='" + x + "' x2='" + x + "' y1='" +
           fixed_digits(y_of(seen.low()), 1) + "' y2='" + fixed_digits(y_of(seen.high()), 1) +
           "'/><circle class='best' r='3.5' cx='" + x + "' cy='" +
           fixed_digits(y_of(seen.share()), 1) + "'><title>probability " +
           fixed_digits(bin.probability, 3) + ": " + std::to_string(seen.right) + " of " +
           std::to_string(seen.count) + " right</title></circle>";
  }
  return svg + "</svg>";
}

std::string line_chart_svg(const std::vector<Curve>& curves, const std::string& x_axis,
                           const std::string& y_axis) {
  std::set<double> values;
  for (const Curve& c : curves) values.insert(c.x.begin(), c.x.end());
  const double first = values.empty() ? 0 : *values.begin(),
               last = values.empty() ? 1 : *values.rbegin();
  const auto at = [&](double x) { return x_of(last > first ? (x - first) / (last - first) : 0.5); };
  std::vector<double> ticks(values.begin(), values.end());
  if (ticks.size() > kTicksMax) {
    ticks.clear();
    for (int i = 0; i <= 4; ++i) ticks.push_back(first + (last - first) * i / 4);
  }
  std::string svg = "<svg class='chart' viewBox='0 0 280 272' role='img' aria-label='" +
                    escape_html(y_axis + " over " + x_axis) + "'>";
  for (int i = 0; i <= 5; ++i) svg += horizontal_line(0.2 * i);
  for (const double x : ticks) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", x);
    svg += "<text class='tick' text-anchor='middle' x='" + fixed_digits(at(x), 1) + "' y='" +
           fixed_digits(y_of(0) + 15, 1) + "'>" + text + "</text>";
  }
  svg += axis_titles(x_axis, y_axis);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::string style = std::to_string(i % kLineStyles);
    svg += "<polyline class='line line-" + style + "' points='";
    for (std::size_t k = 0; k < curves[i].x.size(); ++k)
      svg +=
          fixed_digits(at(curves[i].x[k]), 1) + "," + fixed_digits(y_of(curves[i].y[k]), 1) + " ";
    svg += "'/>";
    if (curves[i].x.size() > kMarksMax) continue;
    for (std::size_t k = 0; k < curves[i].x.size(); ++k) {
      svg += "<circle class='stage-" + style + "' r='2.5' cx='" +
             fixed_digits(at(curves[i].x[k]), 1) + "' cy='" +
             fixed_digits(y_of(curves[i].y[k]), 1) + "'><title>" + escape_html(curves[i].name) +
             ": " + fixed_digits(curves[i].y[k], 3) + "</title></circle>";
    }
  }
  return svg + "</svg>";
}

std::string stacked_bar_svg(const std::vector<BarSegment>& segments, double full_scale,
                            const std::string& unit) {
  constexpr double kWidth = 640, kHeight = 18;
  std::string svg = "<svg class='bar' viewBox='0 0 640 18' preserveAspectRatio='none'>";
  double x = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const double width = full_scale > 0 ? kWidth * segments[i].value / full_scale : 0;
    if (width > 0) {
      svg += "<rect class='stage-" + std::to_string(i) + "' x='" + fixed_digits(x, 2) +
             "' y='0' width='" + fixed_digits(width, 2) + "' height='" + fixed_digits(kHeight, 0) +
             "'><title>" + escape_html(segments[i].name) + ": " +
             fixed_digits(segments[i].value, 1) + " " + unit + "</title></rect>";
    }
    x += width;
  }
  return svg + "</svg>";
}

}  // namespace binpick::app
