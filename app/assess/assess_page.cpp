#include "assess/assess_page.hpp"

#include <algorithm>

#include "assess/assess_sections.hpp"
#include "eval/html_text.hpp"
#include "eval/report_style.hpp"
#include "eval/svg_chart.hpp"
#include "overlay/overlay.hpp"

namespace binpick::app {
namespace {

std::string row_html(const std::vector<std::string>& cells, const char* tag) {
  std::string row = "<tr>";
  for (const std::string& cell : cells)
    row += std::string("<") + tag + ">" + escape_html(cell) + "</" + tag + ">";
  return row + "</tr>\n";
}

std::string section_html(const AssessSection& section) {
  std::string out = "<h2>" + escape_html(section.heading) + "</h2>\n";
  for (const std::string& sentence : section.sentences)
    out += "<p class='lead'>" + escape_html(sentence) + "</p>\n";
  if (section.rows.size() < 2) return out;
  out += "<div class='card'><table>\n" + row_html(section.rows.front(), "th");
  for (std::size_t i = 1; i < section.rows.size(); ++i) out += row_html(section.rows[i], "td");
  return out + "</table></div>\n";
}

std::string tile_html(const std::string& value, const std::string& name) {
  return "<div class='card tile'><b>" + escape_html(value) + "</b><span>" + escape_html(name) +
         "</span></div>\n";
}

std::string tiles_html(const Assessment& a) {
  std::string out = "<div class='tiles'>\n" + tile_html(std::to_string(a.frames), "frames");
  for (const ModelAssessment& model : a.models) {
    const auto steady = std::ranges::count_if(model.parts, &AssessedPart::nearly_always);
    out += tile_html(std::to_string(steady), model.name + " found in nearly every frame");
    out += tile_html(suggestion_text(model), "suggested threshold, " + model.name);
  }
  out += tile_html(fixed_digits(1e3 * a.time.p50_s, 0) + " ms", "median time");
  out += tile_html(fixed_digits(1e3 * a.time.p99_s, 0) + " ms", "p99 of the time");
  return out + "</div>\n";
}

// A bar for each score, from the highest: poses of parts found nearly always, and the others.
std::string histogram_html(const ModelAssessment& model) {
  const int longest = std::ranges::max(model.scores.all);
  if (longest == 0) return "";
  std::string out =
      "<div class='card'><div class='legend'><span><i class='stage-0'></i>" +
      escape_html(model.name) +
      ", found in nearly every frame</span><span><i class='stage-1'></i>others</span></div>\n"
      "<table>\n";
  for (int bin = kScoreBins - 1; bin >= 0; --bin) {
    const auto i = static_cast<std::size_t>(bin);
    const double again = model.scores.found_again[i], all = model.scores.all[i];
    out += "<tr><td>" + fixed_digits(0.1 * bin, 1) + " to " + fixed_digits(0.1 * (bin + 1), 1) +
           "</td><td class='bar-cell'>" +
           stacked_bar_svg({{"found again", again}, {"others", all - again}}, longest, "poses") +
           "</td></tr>\n";
  }
  return out + "</table></div>\n";
}

OverlayStyle style_of(const AssessedPart& part) {
  if (!part.steady()) return OverlayStyle::kFalsePick;
  return part.accepted_nearly_always() ? OverlayStyle::kRight : OverlayStyle::kMiss;
}

}  // namespace

std::string assessment_html(const Assessment& a, const AssessPage& page) {
  std::string body = tiles_html(a);
  for (const AssessSection& section : sections_of(a)) {
    body += section_html(section);
    if (section.heading == "Scores")
      for (const ModelAssessment& model : a.models) body += histogram_html(model);
  }
  body +=
      "<h2>Picture</h2>\n<div class='legend'><span><i class='right'></i>with the threshold's "
      "score in nearly every frame</span><span><i class='miss'></i>found in at least half of "
      "the frames</span><span><i class='wrong'></i>in fewer</span></div>\n<figure><img alt='parts, "
      "numbered' src='data:image/png;base64," +
      base64(page.picture_png) + "'><figcaption>" + escape_html(a.reference) +
      ": the parts at their mean poses, with their median scores.</figcaption></figure>\n"
      "<h2>This run</h2>\n<div class='card'><dl>\n";
  for (const auto& [name, value] : page.facts)
    body += "<dt>" + escape_html(name) + "</dt><dd>" + escape_html(value) + "</dd>\n";
  return "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'>"
         "<meta name='viewport' content='width=device-width, initial-scale=1'><title>" +
         escape_html(page.title) + "</title><style>" + kReportStyle +
         "</style></head>\n<body><main>\n<h1>" + escape_html(page.title) +
         "</h1>\n<p class='lead'>What frames of one scene say, without truth.</p>\n" + body +
         "</dl></div>\n</main></body></html>\n";
}

Picture numbered_picture(Picture picture, const CameraIntrinsics& camera,
                         const Assessment& assessment, std::span<const ObjectModel> models) {
  std::vector<OverlayItem> items;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const Pose from_centre{Mat3::Identity(), -models[m].centre_mm()};
    for (const AssessedPart& part : assessment.models[m].parts) {
      OverlayItem item;
      item.T_cam_obj = part.track.mean * from_centre;
      item.model = &models[m];
      item.label = "#";
      item.label += std::to_string(part.number);
      item.score = part.median_score;
      item.style = style_of(part);
      items.push_back(item);
    }
  }
  OverlayPainter painter(camera);
  return painter.paint(std::move(picture), items);
}

}  // namespace binpick::app
