#include "eval/report_html.hpp"

#include <algorithm>

#include "eval/html_text.hpp"
#include "eval/report_style.hpp"
#include "eval/svg_chart.hpp"

namespace binpick::app {
namespace {

std::string cell(const std::string& text) {
  return "<td>" + text + "</td>";
}

std::string heading_row(const std::vector<std::string>& names) {
  std::string row = "<tr>";
  for (const std::string& name : names) row += "<th>" + name + "</th>";
  return row + "</tr>\n";
}

std::string tile(const std::string& value, const std::string& name) {
  return "<div class='card tile'><b>" + value + "</b><span>" + name + "</span></div>\n";
}

std::string tiles(const ReportContent& c) {
  std::string out = "<div class='tiles'>\n";
  std::size_t frames = 0;
  for (const RunLine& line : c.lines) frames += static_cast<std::size_t>(line.summary.frames);
  const auto mean_tiles = [&out](const MeanScore& mean, const std::string& of) {
    out += tile(fixed_digits(mean.best.f1, 3), "mean F1" + of);
    if (mean.time) out += tile(fixed_digits(1e3 * mean.time->mean_s, 0) + " ms", "mean time" + of);
    if (mean.time)
      out += tile(fixed_digits(1e3 * mean.time->max_s, 0) + " ms", "longest time" + of);
  };
  if (c.score.mean) mean_tiles(*c.score.mean, "");
  if (c.score.mixed_mean) mean_tiles(*c.score.mixed_mean, ", mixed");
  out += tile(std::to_string(frames), "frames searched");
  out += tile(std::to_string(c.faults.size()), "faults");
  return out + "</div>\n";
}

std::string error_cells(const std::optional<PoseError6>& e) {
  std::string out;
  for (int i = 0; i < 6; ++i) out += cell(e ? fixed_digits((*e)[i], 2) : "–");
  return out;
}

template <class Score>
std::string score_cells(const Score& s) {
  return "<td class='main'>" + fixed_digits(s.best.f1, 3) + "</td>" +
         cell(fixed_digits(s.best.precision, 3)) + cell(fixed_digits(s.best.recall, 3)) +
         error_cells(s.mean_abs_error) + cell(fixed_digits(s.add10.f1, 3)) +
         cell(fixed_digits(s.add10.recall, 3)) + cell(fixed_digits(s.add15.f1, 3)) +
         cell(fixed_digits(s.add15.recall, 3)) + cell(fixed_digits(s.mssd_recall, 3));
}

std::string score_section(const ScoreReport& report) {
  const auto part_rows = [](const std::vector<PartScore>& parts) {
    std::string rows;
    for (const PartScore& p : parts) {
      rows += "<tr>" + cell(part_name(p)) + cell(std::to_string(p.frames.size())) +
              cell(std::to_string(p.instances)) + cell(std::to_string(p.detections)) +
              score_cells(p) + "</tr>\n";
    }
    return rows;
  };
  const auto mean_row = [](const char* name, const MeanScore& mean) {
    return "<tr class='mean'>" + cell(name) + cell("") + cell("") + cell("") + score_cells(mean) +
           "</tr>\n";
  };
  const std::string limits = fixed_digits(report.options.limits.mm, 1) + " mm and " +
                             fixed_digits(report.options.limits.deg, 1) + "°";
  std::string out =
      "<h2>Scores</h2>\n<p class='lead'>A pose is right when each of its six parameters is "
      "within " +
      limits + " of an instance that is at least " +
      fixed_digits(100 * report.options.visible_min, 0) +
      " % visible. F1, precision and recall at the best threshold of each part; errors are mean "
      "absolute errors of the right poses; ADD, below 0.10 and 0.15 of the diameter, is ADD-S for "
      "symmetric parts.</p>\n"
      "<div class='card'><table>\n";
  out += heading_row({"part", "images", "to find", "found", "F1", "precision", "recall", "x mm",
                      "y mm", "z mm", "rx °", "ry °", "rz °", "ADD 0.10<br>F1", "recall",
                      "ADD 0.15<br>F1", "recall", "MSSD<br>recall"});
  out += part_rows(report.parts);
  if (report.mean) out += mean_row("mean", *report.mean);
  out += part_rows(report.mixed);
  if (report.mixed_mean) out += mean_row("mean of mixed", *report.mixed_mean);
  return out + "</table></div>\n";
}

std::string curve_section(const ScoreReport& report) {
  std::string out = "<h2>Precision and recall</h2>\n<div class='charts'>\n";
  for (const auto* parts : {&report.parts, &report.mixed}) {
    for (const PartScore& p : *parts) {
      const ThresholdScore& best = p.best;
      std::string at;
      if (best.threshold)
        at = "F1 " + fixed_digits(best.f1, 3) + " at " + fixed_digits(*best.threshold, 2);
      out += "<div class='card'><h3>" + part_name(p) + "<span>" + at + "</span></h3>" +
             precision_recall_svg(p) + "</div>\n";
    }
  }
  return out + "</div>\n";
}

std::string stage_section(const std::vector<RunLine>& lines) {
  double longest = 0;
  for (const RunLine& line : lines) {
    double sum = 0;
    for (const double ms : line.summary.stage_ms) sum += ms;
    longest = std::max(longest, sum);
  }
  std::string out = "<h2>Where the time goes</h2>\n<div class='card'>\n<div class='legend'>";
  for (int i = 0; i < kStageCount; ++i) {
    out += "<span><i class='stage-" + std::to_string(i) + "'></i>" +
           stage_name(static_cast<Stage>(i)) + "</span>";
  }
  out += "</div>\n<table>\n" +
         heading_row({"per frame", "mean ms", "p50", "p99", "max", "mean of each stage"});
  for (const RunLine& line : lines) {
    std::vector<BarSegment> segments;
    for (int i = 0; i < kStageCount; ++i) {
      segments.push_back({stage_name(static_cast<Stage>(i)), line.summary.stage_ms[i]});
    }
    const TimeSummary& time = line.summary.time;
    out += "<tr>" + cell(line.name);
    for (const double s : {time.mean_s, time.p50_s, time.p99_s, time.max_s})
      out += cell(fixed_digits(1e3 * s, 1));
    out += "<td class='bar-cell'>" + stacked_bar_svg(segments, longest, "ms") + "</td></tr>\n";
  }
  return out + "</table></div>\n";
}

std::string level_section(const std::vector<RunLine>& lines) {
  int depths = 0;
  for (const RunLine& line : lines) depths = std::max(depths, line.summary.level_count);
  std::vector<std::string> heading{"mean per frame"};
  for (const char* what :
       {"candidates kept<br>depth ", "templates matched<br>depth ", "time ms<br>depth "}) {
    for (int d = 0; d < depths; ++d) heading.push_back((d == 0 ? what : "") + std::to_string(d));
  }
  std::string out =
      "<h2>Candidates at each level</h2>\n<div class='card'><table>\n" + heading_row(heading);
  for (const RunLine& line : lines) {
    const RunSummary& s = line.summary;
    out += "<tr>" + cell(line.name);
    for (int d = 0; d < depths; ++d) out += cell(fixed_digits(s.candidates[d], 0));
    for (int d = 0; d < depths; ++d) out += cell(fixed_digits(s.templates_evaluated[d], 0));
    for (int d = 0; d < depths; ++d) out += cell(fixed_digits(s.level_ms[d], 1));
    out += "</tr>\n";
  }
  out += "</table></div>\n<h2>Why candidates were dropped</h2>\n<div class='card'><table>\n";
  std::vector<std::string> names{"mean per frame"};
  for (int i = 0; i < kDropReasonCount; ++i) {
    std::string name = drop_reason_name(static_cast<DropReason>(i));
    std::replace(name.begin(), name.end(), '_', ' ');
    names.push_back(name);
  }
  out += heading_row(names);
  for (const RunLine& line : lines) {
    out += "<tr>" + cell(line.name);
    for (const double count : line.summary.dropped) out += cell(fixed_digits(count, 1));
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string figures(const std::vector<ReportPicture>& pictures, const std::string& css_class) {
  std::string out = "<div class='" + css_class + "'>\n";
  for (const ReportPicture& p : pictures) {
    out += "<figure><img alt='" + escape_html(p.caption) + "' src='data:image/png;base64," +
           base64(p.png) + "'><figcaption>" + escape_html(p.caption) + "</figcaption></figure>\n";
  }
  return out + "</div>\n";
}

std::string picture_section(const std::vector<ReportPicture>& pictures) {
  if (pictures.empty()) return "";
  return "<h2>Worst frames</h2>\n<div class='legend'><span><i class='right'></i>right</span>"
         "<span><i class='wrong'></i>false pick</span><span><i class='miss'></i>missed</span>"
         "<span><i class='neutral'></i>neither for nor against</span></div>\n" +
         figures(pictures, "pictures");
}

std::string crop_section(const std::vector<ReportPicture>& pictures) {
  if (pictures.empty()) return "";
  return "<h2>Seen near</h2>\n<div class='legend'><span><i class='miss'></i>true pose</span>"
         "<span><i class='wrong'></i>what was reported there</span></div>\n" +
         figures(pictures, "crops");
}

std::string fault_section(const std::vector<std::string>& faults) {
  if (faults.empty()) return "";
  std::string out = "<h2>Faults</h2>\n<div class='card faults'><ul>\n";
  for (const std::string& fault : faults) out += "<li>" + escape_html(fault) + "</li>\n";
  return out + "</ul></div>\n";
}

std::string model_section(const std::vector<ModelOrigin>& models) {
  std::string out = "<h2>Models</h2>\n<div class='card'><table>\n" +
                    heading_row({"part", "trained for distances mm", "size MB", "training s"});
  for (const ModelOrigin& m : models) {
    out += "<tr>" + cell("obj " + std::to_string(m.obj_id)) +
           cell(fixed_digits(m.range.min_mm, 0) + " – " + fixed_digits(m.range.max_mm, 0)) +
           cell(fixed_digits(static_cast<double>(m.bytes) / 1e6, 1)) +
           cell(m.from_cache ? "from the cache" : fixed_digits(m.train_s, 1)) + "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string fact_section(const std::vector<std::pair<std::string, std::string>>& facts) {
  std::string out = "<h2>This run</h2>\n<div class='card'><dl>\n";
  for (const auto& [name, value] : facts) {
    out += "<dt>" + escape_html(name) + "</dt><dd>" + escape_html(value) + "</dd>\n";
  }
  return out + "</dl></div>\n";
}

}  // namespace

std::string report_html(const ReportContent& c) {
  return "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'>"
         "<meta name='viewport' content='width=device-width, initial-scale=1'><title>" +
         escape_html(c.title) + "</title><style>" + kReportStyle +
         "</style></head>\n<body><main>\n<h1>" + escape_html(c.title) +
         "</h1>\n<p class='lead'>Evaluation of binpick on captured frames with known poses.</p>\n" +
         tiles(c) + fault_section(c.faults) + score_section(c.score) + c.reach +
         curve_section(c.score) + c.reliability + c.curves + stage_section(c.lines) +
         level_section(c.lines) + c.causes + crop_section(c.fault_pictures) +
         picture_section(c.pictures) + model_section(c.models) + fact_section(c.facts) +
         "</main></body></html>\n";
}

}  // namespace binpick::app
