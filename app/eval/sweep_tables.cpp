#include "eval/sweep_tables.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "eval/html_text.hpp"
#include "eval/text_table.hpp"

namespace binpick::app {
namespace {

using nlohmann::json;

constexpr std::size_t kColumnsMax = 10;

std::string level_text(double level) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", level);
  return text;
}

std::string noise_text(double noise_mm) {
  return "depth noise x1 is what the frames have: " + fixed_digits(noise_mm, 2) +
         " mm, at their mean distance";
}

// Every level at which any curve has a value: a part that no frame shows at some visibility has
// none there.
std::vector<double> levels_of(const SweepCurves& c) {
  std::vector<double> levels;
  for (const auto* list : {&c.parts, &c.means}) {
    for (const Curve& curve : *list) levels.insert(levels.end(), curve.x.begin(), curve.x.end());
  }
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  return levels;
}

std::string value_at(const Curve& curve, double level) {
  const auto at = std::find(curve.x.begin(), curve.x.end(), level);
  if (at == curve.x.end()) return "-";
  return fixed_digits(curve.y[static_cast<std::size_t>(at - curve.x.begin())], 3);
}

// Contrast falls where the others rise: worse is to the right.
bool falls(const SweepCurves& c) {
  return !c.parts.empty() && c.parts[0].x.size() > 1 && c.parts[0].x.front() > c.parts[0].x.back();
}

std::string legend(const std::vector<Curve>& curves) {
  std::string out = "<div class='legend'>";
  for (std::size_t i = 0; i < curves.size(); ++i) {
    out += "<span><i class='stage-" + std::to_string(i % kLineStyles) + "'></i>" +
           escape_html(curves[i].name) + "</span>";
  }
  return out + "</div>\n";
}

json curves_to_json(const std::vector<Curve>& curves) {
  json list = json::array();
  for (const Curve& c : curves) list.push_back({{"name", c.name}, {"x", c.x}, {"y", c.y}});
  return list;
}

}  // namespace

std::string sweep_table(const std::vector<SweepCurves>& curves, double noise_mm) {
  std::string out;
  for (const SweepCurves& c : curves) {
    std::vector<double> levels = levels_of(c);
    if (levels.empty() || levels.size() > kColumnsMax) continue;
    if (falls(c)) std::reverse(levels.begin(), levels.end());
    TextTable table;
    std::vector<std::string> heading{c.y_axis + " over " + c.x_axis};
    for (const double level : levels) heading.push_back(level_text(level));
    table.row(heading);
    const auto add = [&](const Curve& curve, const std::string& name) {
      std::vector<std::string> row{name};
      for (const double level : levels) row.push_back(value_at(curve, level));
      table.row(std::move(row));
    };
    for (const Curve& curve : c.parts) add(curve, curve.name);
    for (const Curve& curve : c.means) add(curve, "mean at the threshold: " + curve.name);
    out += table.text() + "\n";
  }
  if (noise_mm > 0) out += noise_text(noise_mm) + "\n";
  return out;
}

std::string sweep_section_html(const std::vector<SweepCurves>& curves, double noise_mm) {
  if (curves.empty()) return "";
  std::string out =
      "<h2>How scores fall</h2>\n<p class='lead'>F1 of each part at its best threshold over frames "
      "made worse in memory, the same way in every run, and beside it the means over the parts at "
      "the fixed threshold, precision over those of which anything is found. Noise comes in blocks "
      "of 2x2 px and grows with the square of the "
      "distance" +
      std::string(noise_mm > 0 ? "; " + noise_text(noise_mm) : "") +
      ". Missing depth comes in round blobs. Light is shading computed from the measured normals, "
      "without shadows. Focal length and principal point are wrong for the detector alone.</p>\n";
  out += legend(curves.front().parts) + "<div class='charts'>\n";
  for (const SweepCurves& c : curves) {
    out += "<div class='card'><h3>" + escape_html(c.name) + "</h3>" +
           line_chart_svg(c.parts, c.x_axis, c.y_axis) + "</div>\n";
    if (c.means.empty()) continue;
    out += "<div class='card'><h3>" + escape_html(c.name) + "<span>at the threshold</span></h3>" +
           line_chart_svg(c.means, c.x_axis, "mean") + legend(c.means) + "</div>\n";
  }
  return out + "</div>\n";
}

json sweep_to_json(const std::vector<SweepCurves>& curves, double noise_mm) {
  json out;
  for (const SweepCurves& c : curves) {
    out[c.name] = {{"x", c.x_axis},
                   {"y", c.y_axis},
                   {"parts", curves_to_json(c.parts)},
                   {"means_at_threshold", curves_to_json(c.means)}};
  }
  if (noise_mm > 0) out["noise"]["x1_mm"] = noise_mm;
  return out;
}

}  // namespace binpick::app
