#include "eval/fault_tables.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "eval/html_text.hpp"
#include "eval/text_table.hpp"

namespace binpick::app {
namespace {

using nlohmann::json;

std::vector<std::string> reach_heading() {
  std::vector<std::string> names{"what is reachable", "to find"};
  for (const char* start : {"run", "from truth", "from template"}) {
    names.push_back(std::string("F1 ") + start);
    names.emplace_back("recall");
  }
  for (int i = 1; i < kLossCount; ++i)
    names.push_back(std::string(i == 1 ? "lost to " : "") + loss_name(static_cast<Loss>(i)));
  return names;
}

// `scores`: false for a sum over parts, whose thresholds differ.
std::vector<std::string> reach_row(const PartFaults& p, bool scores) {
  std::vector<std::string> row{p.name, std::to_string(p.targets)};
  for (const ThresholdScore* s : {&p.run, &p.from_truth, &p.from_template}) {
    row.push_back(scores ? fixed_digits(s->f1, 3) : "");
    row.push_back(scores ? fixed_digits(s->recall, 3) : "");
  }
  for (int i = 1; i < kLossCount; ++i)
    row.push_back(std::to_string(p.lost[static_cast<std::size_t>(i)]));
  return row;
}

std::vector<std::string> pick_heading() {
  std::vector<std::string> names{"false picks"};
  for (int i = 0; i < kFalsePickKindCount; ++i)
    names.emplace_back(false_pick_name(static_cast<FalsePickKind>(i)));
  return names;
}

std::vector<std::string> pick_row(const PartFaults& p, bool) {
  std::vector<std::string> row{p.name};
  for (const int n : p.false_picks) row.push_back(std::to_string(n));
  return row;
}

PartFaults sum_of(const std::vector<PartFaults>& parts) {
  PartFaults sum;
  sum.name = "all";
  for (const PartFaults& p : parts) {
    sum.targets += p.targets;
    sum.found += p.found;
    for (std::size_t i = 0; i < p.lost.size(); ++i) sum.lost[i] += p.lost[i];
    for (std::size_t i = 0; i < p.false_picks.size(); ++i) sum.false_picks[i] += p.false_picks[i];
  }
  return sum;
}

std::string frame_text(const drivers::FrameId& id) {
  return std::to_string(id.scene_id) + "/" + std::to_string(id.im_id);
}

std::string html_row(const std::vector<std::string>& cells, const char* tag,
                     const std::string& row_class = "") {
  std::string row = row_class.empty() ? "<tr>" : "<tr class='" + row_class + "'>";
  for (const std::string& c : cells)
    row += std::string("<") + tag + ">" + escape_html(c) + "</" + tag + ">";
  return row + "</tr>\n";
}

template <class Heading, class Row>
std::string html_table(const std::vector<PartFaults>& parts, Heading&& heading, Row&& row) {
  std::string out = "<div class='card'><table>\n" + html_row(heading(), "th");
  for (const PartFaults& p : parts) out += html_row(row(p, true), "td");
  if (parts.size() > 1) out += html_row(row(sum_of(parts), false), "td", "mean");
  return out + "</table></div>\n";
}

json score_json(const ThresholdScore& s) {
  return {{"f1", s.f1},
          {"recall", s.recall},
          {"precision", s.precision},
          {"threshold", s.threshold ? json(*s.threshold) : json()}};
}

json start_to_json(const OracleStart& s) {
  json out{{"posed", s.posed},
           {"right", s.right()},
           {"reported", s.reported()},
           {"error", s.error},
           {"probability", s.detection.score},
           {"outranked", s.outranked},
           {"owned_by_better", s.owned_by_better},
           {"rank", s.rank}};
  for (int i = 0; i < kScoreTermCount; ++i)
    out["terms"][score_term_name(static_cast<ScoreTerm>(i))] =
        s.detection.score_terms[static_cast<std::size_t>(i)];
  out["objection"] = s.objected ? json(drop_reason_name(s.objection)) : json();
  return out;
}

json missed_to_json(const MissedPart& m) {
  const ReferenceFinding& f = m.target->finding;
  json seen = json::object();
  for (int i = 0; i < kCheckpointCount; ++i) {
    const Sighting& s = f.sightings[static_cast<std::size_t>(i)];
    if (s.passed())
      seen[checkpoint_name(static_cast<Checkpoint>(i))] = {{"place", s.place}, {"of", s.count}};
  }
  json out{{"scene_id", m.target->frame.scene_id},
           {"im_id", m.target->frame.im_id},
           {"instance", m.target->instance},
           {"visib_fract", m.visible_fraction},
           {"lost_to", loss_name(m.cause.loss)},
           {"why", m.cause.why},
           {"seen", seen},
           {"template_scores", f.template_scores},
           {"from_truth", start_to_json(f.from_truth)},
           {"from_template", start_to_json(f.from_template)},
           {"measured_share", m.target->moved.measured_share()}};
  out["pixels_owner"] = json();
  if (f.has_owner) {
    out["pixels_owner"] = {{"probability", f.owner.score},
                           {"rank", f.owner_rank},
                           {"share", f.owner_share},
                           {"truth_advantage", m.target->owner.advantage()}};
  }
  return out;
}

}  // namespace

std::string fault_table(const std::vector<PartFaults>& parts) {
  TextTable reach, picks, missed;
  reach.row(reach_heading());
  picks.row(pick_heading());
  missed.row({"missed parts"});
  const auto add = [&](const PartFaults& p, bool scores) {
    reach.row(reach_row(p, scores));
    picks.row(pick_row(p, scores));
  };
  for (const PartFaults& p : parts) {
    add(p, true);
    for (const MissedPart& m : p.missed) {
      missed.row({p.name + ", " + frame_text(m.target->frame) + " #" +
                  std::to_string(m.target->instance) + ", " +
                  fixed_digits(100 * m.visible_fraction, 0) +
                  " % visible: " + loss_name(m.cause.loss) + ": " + m.cause.why});
    }
  }
  if (parts.size() > 1) add(sum_of(parts), false);
  return reach.text() + "\n" + picks.text() + "\n" + missed.text();
}

std::string reach_section_html(const std::vector<PartFaults>& parts) {
  if (parts.empty()) return "";
  std::string out =
      "<h2>What is reachable</h2>\n<p class='lead'>F1 and recall of the run, and what they would "
      "be "
      "were every part begun at its true pose (last refinement and verification) or at the "
      "template "
      "nearest to it (all pose stages), each at its own best threshold and beside the run's false "
      "picks. What the run missed, by cause: <b>truth</b>, where the measured depth fits another "
      "pose better than the one given; <b>data</b>, where it does not tell the true pose from the "
      "one that took its place, or shows nothing of the part; <b>verification</b> and "
      "<b>ranking</b>, where even a pose begun at the truth gets too low a score, or loses its "
      "pixels to another; else the stage that lost the last pose near the truth.</p>\n";
  out += html_table(parts, reach_heading, reach_row);
  return out + "<h2>False picks</h2>\n" + html_table(parts, pick_heading, pick_row);
}

std::string cause_section_html(const std::vector<PartFaults>& parts, const TruthByFrame& truth,
                               const std::vector<ResultRow>& rows) {
  if (parts.empty()) return "";
  std::string out = "<h2>Every fault and its cause</h2>\n<div class='card causes'><table>\n" +
                    html_row({"part", "image", "fault", "cause"}, "th");
  for (const PartFaults& p : parts) {
    for (const MissedPart& m : p.missed) {
      out += html_row({p.name, frame_text(m.target->frame),
                       "missed #" + std::to_string(m.target->instance) + ", " +
                           fixed_digits(100 * m.visible_fraction, 0) + " % visible",
                       std::string(loss_name(m.cause.loss)) + ": " + m.cause.why},
                      "td");
    }
    for (const FalsePick& pick : p.wrong) {
      const ResultRow& row = rows[pick.row_index];
      out += html_row({p.name, frame_text(row.frame), "false pick, " + fixed_digits(row.score, 2),
                       false_pick_text(pick, truth.at(row.frame))},
                      "td");
    }
  }
  return out + "</table></div>\n";
}

json faults_to_json(const std::vector<PartFaults>& parts, const std::vector<ResultRow>& rows) {
  json list = json::array();
  for (const PartFaults& p : parts) {
    json lost, kinds, missed = json::array(), wrong = json::array();
    for (int i = 1; i < kLossCount; ++i)
      lost[loss_name(static_cast<Loss>(i))] = p.lost[static_cast<std::size_t>(i)];
    for (int i = 0; i < kFalsePickKindCount; ++i)
      kinds[false_pick_name(static_cast<FalsePickKind>(i))] =
          p.false_picks[static_cast<std::size_t>(i)];
    for (const MissedPart& m : p.missed) missed.push_back(missed_to_json(m));
    for (const FalsePick& pick : p.wrong) {
      const ResultRow& row = rows[pick.row_index];
      wrong.push_back({{"scene_id", row.frame.scene_id},
                       {"im_id", row.frame.im_id},
                       {"probability", row.score},
                       {"kind", false_pick_name(pick.kind)},
                       {"instance", pick.instance < 0 ? json() : json(pick.instance)},
                       {"shift_mm", pick.shift_mm},
                       {"turn_deg", pick.turn_deg}});
    }
    list.push_back({{"part", p.name},
                    {"obj_id", p.obj_id},
                    {"threshold", p.threshold},
                    {"targets", p.targets},
                    {"found", p.found},
                    {"run", score_json(p.run)},
                    {"from_truth", score_json(p.from_truth)},
                    {"from_template", score_json(p.from_template)},
                    {"lost_to", lost},
                    {"false_picks", kinds},
                    {"missed", missed},
                    {"wrong", wrong}});
  }
  return list;
}

}  // namespace binpick::app
