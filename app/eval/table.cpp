#include "eval/table.hpp"

#include <cstdio>

#include "eval/text_table.hpp"

namespace binpick::app {
namespace {

std::string number(double value, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string errors(const std::optional<PoseError6>& e, int first) {
  if (!e) return "-";
  return number((*e)[first], 2) + " " + number((*e)[first + 1], 2) + " " +
         number((*e)[first + 2], 2);
}

// The columns that parts and means share.
template <class Score>
std::vector<std::string> score_cells(const Score& s, const TimeSummary& time) {
  const auto ms = [&time](double seconds) {
    return time.count > 0 ? number(1e3 * seconds, 1) : std::string("-");
  };
  return {number(s.best.f1, 3),
          number(s.best.precision, 3),
          number(s.best.recall, 3),
          errors(s.mean_abs_error, 0),
          errors(s.mean_abs_error, 3),
          number(s.add10.f1, 3),
          number(s.add10.recall, 3),
          number(s.add15.f1, 3),
          number(s.add15.recall, 3),
          number(s.mssd_recall, 3),
          ms(time.mean_s),
          ms(time.p50_s),
          ms(time.p99_s),
          ms(time.max_s)};
}

void add_part(TextTable& table, const PartScore& p, bool fixed) {
  std::vector<std::string> row{part_name(p), std::to_string(p.frames.size()),
                               std::to_string(p.instances), std::to_string(p.detections),
                               p.best.threshold ? number(*p.best.threshold, 3) : "-"};
  if (fixed) row.push_back(p.fixed ? number(p.fixed->f1, 3) : "-");
  const std::vector<std::string> cells = score_cells(p, p.time);
  row.insert(row.end(), cells.begin(), cells.end());
  table.row(std::move(row));
}

void add_mean(TextTable& table, const char* name, const MeanScore& mean, bool fixed) {
  std::vector<std::string> row{name, "", "", "", ""};
  if (fixed) row.push_back(mean.fixed_f1 ? number(*mean.fixed_f1, 3) : "-");
  const std::vector<std::string> cells = score_cells(mean, mean.time.value_or(TimeSummary{}));
  row.insert(row.end(), cells.begin(), cells.end());
  table.row(std::move(row));
}

}  // namespace

std::string score_table(const ScoreReport& report) {
  TextTable table;
  const bool fixed = report.options.fixed_threshold.has_value();
  std::vector<std::string> heading{"part", "images", "to find", "found", "threshold"};
  if (fixed) heading.push_back("F1@" + number(*report.options.fixed_threshold, 2));
  for (const char* name :
       {"F1", "precision", "recall", "x y z [mm]", "rx ry rz [deg]", "ADD.10 F1", "recall",
        "ADD.15 F1", "recall", "MSSD", "mean [ms]", "p50", "p99", "max"}) {
    heading.emplace_back(name);
  }
  table.row(heading);
  for (const PartScore& p : report.parts) add_part(table, p, fixed);
  if (report.mean) add_mean(table, "mean", *report.mean, fixed);
  for (const PartScore& p : report.mixed) add_part(table, p, fixed);
  if (report.mixed_mean) add_mean(table, "mean of mixed", *report.mixed_mean, fixed);
  return table.text();
}

std::string stage_table(const std::vector<RunLine>& lines) {
  TextTable table;
  std::vector<std::string> heading{"stage times [ms]"};
  for (int i = 0; i < kStageCount; ++i) heading.emplace_back(stage_name(static_cast<Stage>(i)));
  heading.emplace_back("sum");
  table.row(heading);
  for (const RunLine& line : lines) {
    std::vector<std::string> row{line.name};
    double sum = 0;
    for (const double ms : line.summary.stage_ms) row.push_back(number(ms, 1)), sum += ms;
    row.push_back(number(sum, 1));
    table.row(std::move(row));
  }
  return table.text();
}

std::string level_table(const std::vector<RunLine>& lines) {
  TextTable levels;
  levels.row({"per frame", "depth", "time [ms]", "templates matched", "candidates kept"});
  TextTable drops;
  std::vector<std::string> heading{"dropped per frame"};
  for (int i = 0; i < kDropReasonCount; ++i)
    heading.emplace_back(drop_reason_name(static_cast<DropReason>(i)));
  drops.row(heading);
  for (const RunLine& line : lines) {
    const RunSummary& s = line.summary;
    for (int d = 0; d < s.level_count; ++d) {
      levels.row({d == 0 ? line.name : "", std::to_string(d), number(s.level_ms[d], 2),
                  number(s.templates_evaluated[d], 0), number(s.candidates[d], 1)});
    }
    std::vector<std::string> row{line.name};
    for (const double count : s.dropped) row.push_back(number(count, 1));
    drops.row(std::move(row));
  }
  return levels.text() + "\n" + drops.text();
}

}  // namespace binpick::app
