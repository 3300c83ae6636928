#include "eval/svg_chart.hpp"

#include "eval/html_text.hpp"

namespace binpick::app {
namespace {

// The plot's square in the drawing's units; ticks and titles stand outside.
constexpr double kLeft = 44, kTop = 12, kSide = 220;

double x_of(double recall) {
  return kLeft + kSide * recall;
}
double y_of(double precision) {
  return kTop + kSide * (1 - precision);
}

std::string grid() {
  std::string svg;
  for (int i = 0; i <= 5; ++i) {
    const double v = 0.2 * i;
    const std::string tick = fixed_digits(v, 1);
    svg += "<line class='grid' x1='" + fixed_digits(x_of(v), 1) + "' y1='" +
           fixed_digits(y_of(0), 1) + "' x2='" + fixed_digits(x_of(v), 1) + "' y2='" +
           fixed_digits(y_of(1), 1) + "'/>";
    svg += "<line class='grid' x1='" + fixed_digits(x_of(0), 1) + "' y1='" +
           fixed_digits(y_of(v), 1) + "' x2='" + fixed_digits(x_of(1), 1) + "' y2='" +
           fixed_digits(y_of(v), 1) + "'/>";
    svg += "<text class='tick' text-anchor='middle' x='" + fixed_digits(x_of(v), 1) + "' y='" +
           fixed_digits(y_of(0) + 15, 1) + "'>" + tick + "</text>";
    svg += "<text class='tick' text-anchor='end' x='" + fixed_digits(x_of(0) - 6, 1) + "' y='" +
           fixed_digits(y_of(v) + 4, 1) + "'>" + tick + "</text>";
  }
  svg += "<text class='axis' text-anchor='middle' x='" + fixed_digits(x_of(0.5), 1) + "' y='" +
         fixed_digits(y_of(0) + 32, 1) + "'>recall</text>";
  svg += "<text class='axis' text-anchor='middle' transform='translate(11 " +
         fixed_digits(y_of(0.5), 1) + ") rotate(-90)'>precision</text>";
  return svg;
}

}  // namespace

std::string precision_recall_svg(const PartScore& part) {
  std::string svg =
      "<svg class='chart' viewBox='0 0 280 272' role='img' aria-label='precision over recall of " +
      std::string("object ") + std::to_string(part.obj_id) + "'>" + grid();
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
