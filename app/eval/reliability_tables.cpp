#include "eval/reliability_tables.hpp"

#include <nlohmann/json.hpp>

#include "eval/html_text.hpp"
#include "eval/svg_chart.hpp"
#include "eval/text_table.hpp"

namespace binpick::app {
namespace {

using nlohmann::json;

std::string share_text(const RightShare& seen) {
  return seen.count > 0 ? fixed_digits(seen.share(), 3) : "-";
}

std::string interval_text(const RightShare& seen) {
  return fixed_digits(seen.low(), 3) + " .. " + fixed_digits(seen.high(), 3);
}

std::string range_text(const ReliabilityBin& bin) {
  return fixed_digits(bin.from, 2) + " .. " + fixed_digits(bin.to, 2);
}

// The rows of both tables, headings first; text and HTML differ in their frame alone.
using Rows = std::vector<std::vector<std::string>>;

Rows part_rows(const std::vector<Reliability>& parts) {
  Rows rows{{"reliability", "poses", "calibration error",
             "poses at " + fixed_digits(parts.back().threshold, 2), "right", "95 % interval"}};
  for (const Reliability& r : parts) {
    rows.push_back({r.name, std::to_string(r.count), fixed_digits(r.calibration_error, 3),
                    std::to_string(r.accepted.count), share_text(r.accepted),
                    interval_text(r.accepted)});
  }
  return rows;
}

Rows bin_rows(const Reliability& r) {
  Rows rows{{"probability", "poses", "mean", "right", "95 % interval"}};
  for (const ReliabilityBin& bin : r.bins) {
    if (bin.seen.count == 0) continue;
    rows.push_back({range_text(bin), std::to_string(bin.seen.count),
                    fixed_digits(bin.probability, 3), share_text(bin.seen),
                    interval_text(bin.seen)});
  }
  return rows;
}

std::string as_text(const Rows& rows) {
  TextTable table;
  for (const std::vector<std::string>& row : rows) table.row(row);
  return table.text();
}

std::string as_html(const Rows& rows) {
  std::string out = "<div class='card'><table>\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string tag = i == 0 ? "th" : "td";
    out += "<tr>";
    for (const std::string& cell : rows[i])
      out += "<" + tag + ">" + escape_html(cell) + "</" + tag + ">";
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

json share_to_json(const RightShare& seen) {
  json out{{"count", seen.count}, {"right", seen.right}, {"interval", {seen.low(), seen.high()}}};
  out["share"] = seen.count > 0 ? json(seen.share()) : json();
  return out;
}

}  // namespace

std::string reliability_table(const std::vector<Reliability>& parts) {
  if (parts.empty()) return "";
  return as_text(part_rows(parts)) + "\n" + as_text(bin_rows(parts.back()));
}

std::string reliability_section_html(const std::vector<Reliability>& parts) {
  if (parts.empty()) return "";
  std::string out =
      "<h2>Reliability of the score</h2>\n<p class='lead'>A score is the probability that the pose "
      "is right: of the poses with about one score, that share ought to be right, which is the "
      "diagonal. Bars are 95 % intervals. A pose within the limits of any part is right, whether "
      "that part had to be found or not; a repeated pose is wrong. The calibration error is the "
      "mean distance from the diagonal, weighted by the poses of each bin.</p>\n" +
      as_html(part_rows(parts)) + "<div class='charts'>\n";
  for (const Reliability& r : parts) {
    out += "<div class='card'><h3>" + escape_html(r.name) + "<span>" + std::to_string(r.count) +
           " poses, error " + fixed_digits(r.calibration_error, 3) + "</span></h3>" +
           reliability_svg(r) + "</div>\n";
  }
  return out + "</div>\n" + as_html(bin_rows(parts.back()));
}

json reliability_to_json(const std::vector<Reliability>& parts) {
  json list = json::array();
  for (const Reliability& r : parts) {
    json bins = json::array();
    for (const ReliabilityBin& bin : r.bins) {
      json out = share_to_json(bin.seen);
      out["from"] = bin.from;
      out["to"] = bin.to;
      out["probability"] = bin.seen.count > 0 ? json(bin.probability) : json();
      bins.push_back(out);
    }
    json accepted = share_to_json(r.accepted);
    accepted["threshold"] = r.threshold;
    list.push_back({{"name", r.name},
                    {"count", r.count},
                    {"calibration_error", r.calibration_error},
                    {"accepted", accepted},
                    {"bins", bins}});
  }
  return list;
}

}  // namespace binpick::app
