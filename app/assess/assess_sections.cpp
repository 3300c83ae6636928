#include "assess/assess_sections.hpp"

#include <algorithm>
#include <sstream>

#include "binpick/geometry/angle.hpp"
#include "eval/html_text.hpp"
#include "eval/text_table.hpp"

namespace binpick::app {
namespace {

// Between these a claimed standard deviation is about the measured one: of ten poses a measured one
// is off by a quarter.
constexpr double kClaimLow = 0.75, kClaimHigh = 1.5;

std::string percent_text(double share, int digits = 1) {
  return fixed_digits(100 * share, digits) + " %";
}

// Of wrong poses, where `seen` counts right ones.
std::string wrong_interval(const RightShare& seen) {
  return percent_text(1 - seen.high()) + " to " + percent_text(1 - seen.low());
}

std::string of(int count, int all) {
  return std::to_string(count) + " of " + std::to_string(all);
}

std::vector<std::string> picks_row(const std::string& name, const WrongPicks& p) {
  if (p.poses.count == 0) return {name, fixed_digits(p.threshold, 2), "-", "-", "0", "-", "0", "-"};
  return {name,
          fixed_digits(p.threshold, 2),
          percent_text(p.share()),
          percent_text(p.by_score),
          of(p.poses.count - p.poses.right, p.poses.count),
          wrong_interval(p.poses),
          of(p.parts.count - p.parts.right, p.parts.count),
          wrong_interval(p.parts)};
}

std::string numbers_text(const std::vector<int>& numbers) {
  std::string out;
  for (const int n : numbers) out += (out.empty() ? "#" : ", #") + std::to_string(n);
  return out;
}

// Parts with the threshold's score that come and go.
std::string come_and_go_sentence(const ModelAssessment& model) {
  std::vector<int> numbers;
  for (const AssessedPart& part : model.parts)
    if (part.accepted > 0 && !part.steady()) numbers.push_back(part.number);
  if (numbers.empty()) return "";
  return " Parts with the configured threshold's score that are found in less than half of the "
         "frames: " +
         numbers_text(numbers) +
         "; see in the picture whether these are wrong poses, or right ones that come and go.";
}

std::string promise_sentence(const ModelAssessment& model, double wrong_max) {
  const std::string most = percent_text(wrong_max);
  if (!model.suggested)
    return model.name + ": no threshold up to 0.99 keeps the expected wrong picks at " + most +
           " or less." + come_and_go_sentence(model);
  const WrongPicks& p = *model.suggested;
  const double worst = 1 - p.parts.low();
  const std::string rests = model.name + ": the suggestion rests on " +
                            std::to_string(p.poses.count) + " poses of " +
                            std::to_string(p.parts.count) + " parts";
  if (worst <= wrong_max)
    return rests + ", enough to promise at most " + most + " wrong picks." +
           come_and_go_sentence(model);
  return rests + ", too few to promise " + most + ": up to " + percent_text(worst) +
         " wrong is in keeping with them (95 %). " + std::to_string(parts_to_promise(wrong_max)) +
         " different parts without a wrong one would be needed; assess other bins too." +
         come_and_go_sentence(model);
}

AssessSection threshold_section(const Assessment& a) {
  AssessSection s{"Suggested threshold", {}, {}};
  s.sentences.push_back(
      "Expected wrong picks: the larger of what the scores say (mean of 1 - score) and of the "
      "share "
      "of poses whose part is not found in half of the frames. A mistake that a scene repeats in "
      "every frame is not seen here; so its parts count once for the last interval.");
  s.rows.push_back({"part", "threshold", "wrong picks", "by score", "poses not again",
                    "95 % by poses", "parts not again", "95 % by parts"});
  for (const ModelAssessment& model : a.models) {
    if (model.suggested) s.rows.push_back(picks_row(model.name + ", suggested", *model.suggested));
    s.rows.push_back(picks_row(model.name + ", configured", model.at_threshold));
    s.sentences.push_back(promise_sentence(model, a.settings.wrong_picks_max));
  }
  return s;
}

std::string sigma_text(const Repeatability& r, std::size_t direction) {
  if (r.count < 2) return "-";
  return r.unobservable[direction] ? "free" : fixed_digits(r.sigma[direction], 3);
}

// Without the name where there is one kind only.
std::string part_text(const Assessment& a, const ModelAssessment& model, const AssessedPart& part) {
  return numbers_text({part.number}) + (a.models.size() > 1 ? " " + model.name : "");
}

AssessSection part_section(const Assessment& a) {
  const std::string threshold = fixed_digits(a.settings.threshold, 2);
  AssessSection s{
      "Parts",
      {"Numbers as in the picture. Found: frames in which the part is found at all, "
       "and with a score of " +
       threshold +
       " and more, of those in which its place is in view. Flips: frames in which it is "
       "turned by a near symmetry that the sensor cannot tell. Same place: the part found "
       "there in other frames, in another pose. Standard deviations "
       "from frame to frame in camera axes; free: a rotation that the part's shape "
       "does not show."},
      {}};
  std::vector<std::string> heading{
      "part",  "place x y z [mm]", "found", "at " + threshold, "median score",
      "flips", "same place"};
  heading.insert(heading.end(), std::begin(kDirectionNames), std::end(kDirectionNames));
  s.rows.push_back(heading);
  for (const ModelAssessment& model : a.models) {
    for (const AssessedPart& part : model.parts) {
      const Vec3& t = part.track.mean.t_mm;
      std::vector<std::string> row{
          part_text(a, model, part),
          fixed_digits(t.x(), 0) + " " + fixed_digits(t.y(), 0) + " " + fixed_digits(t.z(), 0),
          of(part.found, part.frames),
          of(part.accepted, part.frames),
          fixed_digits(part.median_score, 2),
          std::to_string(part.flips),
          part.same_place > 0 ? numbers_text({part.same_place}) : ""};
      for (std::size_t d = 0; d < kDirectionCount; ++d)
        row.push_back(sigma_text(part.repeatability, d));
      s.rows.push_back(std::move(row));
    }
    if (model.passing_poses > 0)
      s.sentences.push_back(model.name + ": " + std::to_string(model.passing_poses) +
                            " poses beside these were seen too seldom or are too improbable for a "
                            "line, with scores up to " +
                            fixed_digits(model.passing_score_max, 2) + ".");
  }
  return s;
}

std::string claim_sentence(const ModelAssessment& model) {
  std::vector<double> claims;
  for (const double claim : model.spread.claim)
    if (claim > 0) claims.push_back(claim);
  if (claims.empty()) return model.name + ": nothing scatters, so claims cannot be compared.";
  const double claim = median_of(std::move(claims));
  const std::string times = model.name + ": poses claim " + fixed_digits(claim, 1) +
                            " times the standard deviation that is measured";
  if (claim < kClaimLow)
    return times + ": they scatter more than they claim; multiply the claimed ones by " +
           fixed_digits(1 / claim, 1) + " or more before you rely on them.";
  if (claim <= kClaimHigh)
    return times +
           ": the claims hold for the random share, and leave nothing for errors that "
           "every frame repeats.";
  return times +
         ": they claim more than the random share, which leaves room for errors that "
         "every frame repeats; nothing here speaks against the claims.";
}

AssessSection spread_section(const Assessment& a) {
  AssessSection s{"Repeatability and claimed accuracy", {}, {}};
  s.sentences.push_back(
      a.settings.moved
          ? "Parts found in at least half of the frames. The motion of the scene was estimated "
            "from "
            "the same poses, and fits their errors a little: the spread is somewhat larger than "
            "shown."
          : "Parts found in at least half of the frames. A scene that stands still repeats errors "
            "of calibration, CAD and depth in every frame: the spread is the random share only, "
            "not the accuracy.");
  std::vector<std::string> heading{"part"};
  heading.insert(heading.end(), std::begin(kDirectionNames), std::end(kDirectionNames));
  s.rows.push_back(heading);
  const auto add = [&](const std::string& name, const auto& values, int digits, bool ratio) {
    std::vector<std::string> row{name};
    for (const double v : values) row.push_back(ratio && v == 0 ? "-" : fixed_digits(v, digits));
    s.rows.push_back(std::move(row));
  };
  for (const ModelAssessment& model : a.models) {
    if (model.spread_parts == 0) {
      s.sentences.push_back(model.name + ": no part was found often enough.");
      continue;
    }
    const std::string name = model.name + " (" + std::to_string(model.spread_parts) +
                             (model.spread_parts == 1 ? " part)" : " parts)");
    add(name + ", median", model.spread.median, 3, false);
    add(name + ", worst", model.spread.worst, 3, false);
    add(name + ", claimed / measured", model.spread.claim, 1, true);
    s.sentences.push_back(claim_sentence(model));
  }
  return s;
}

AssessSection score_section(const Assessment& a) {
  AssessSection s{"Scores",
                  {"How many poses have which score: all, those of parts found in nearly every "
                   "frame (90 %), and the others."},
                  {}};
  std::vector<std::string> heading{"score"};
  for (const ModelAssessment& model : a.models)
    for (const char* what : {"all", "found again", "others"})
      heading.push_back((a.models.size() > 1 ? model.name + ", " : "") + what);
  s.rows.push_back(heading);
  for (int bin = kScoreBins - 1; bin >= 0; --bin) {
    const auto i = static_cast<std::size_t>(bin);
    std::vector<std::string> row{fixed_digits(0.1 * bin, 1) + " to " +
                                 fixed_digits(0.1 * (bin + 1), 1)};
    for (const ModelAssessment& model : a.models) {
      const int all = model.scores.all[i], again = model.scores.found_again[i];
      for (const int n : {all, again, all - again}) row.push_back(std::to_string(n));
    }
    s.rows.push_back(std::move(row));
  }
  return s;
}

AssessSection limit_section(const Assessment& a) {
  AssessSection s{"What limits it", {}, {}};
  for (const ModelAssessment& model : a.models) {
    for (const LimitFinding& finding : model.limits) {
      s.sentences.push_back(model.name + " " + numbers_text(finding.parts) + ": " + finding.text +
                            ".");
    }
    if (model.limits.empty() && !model.parts.empty())
      s.sentences.push_back(model.name +
                            ": every part is found with the threshold's score in nearly every "
                            "frame.");
  }
  return s;
}

AssessSection motion_section(const Assessment& a) {
  AssessSection s{"Motion of the scene", {}, {}};
  s.sentences.push_back("From " + a.reference + ", by the poses that agree with one motion.");
  s.sentences.insert(s.sentences.end(), a.refused.begin(), a.refused.end());
  s.rows.push_back({"frame", "shift [mm]", "rotation [deg]", "poses that agree", "next best"});
  for (const FrameMotion& f : a.motions)
    s.rows.push_back(
        {f.name, fixed_digits(f.motion.shift_mm, 2), fixed_digits(f.motion.angle_rad / kDegree, 2),
         of(f.motion.agreeing, f.motion.compared), std::to_string(f.motion.next_best)});
  return s;
}

AssessSection frame_section(const Assessment& a) {
  const auto ms = [](double seconds) { return fixed_digits(1e3 * seconds, 1); };
  AssessSection s{"Frames", {}, {}};
  s.rows.push_back({"frames", "time p50 [ms]", "p99", "max", "depth noise [mm]"});
  s.rows.push_back({std::to_string(a.frames), ms(a.time.p50_s), ms(a.time.p99_s), ms(a.time.max_s),
                    a.noise_mm > 0 ? fixed_digits(a.noise_mm, 3) : "-"});
  return s;
}

// Broken between words, each line indented.
std::string wrapped(const std::string& sentence) {
  constexpr std::size_t kColumns = 100;
  std::string out;
  std::size_t column = kColumns;
  std::istringstream words(sentence);
  for (std::string word; words >> word; column += 1 + word.size()) {
    if (column + 1 + word.size() > kColumns) {
      out += out.empty() ? " " : "\n ";
      column = 1;
    }
    out += ' ';
    out += word;
  }
  out += '\n';
  return out;
}

}  // namespace

std::string suggestion_text(const ModelAssessment& model) {
  return model.suggested ? fixed_digits(model.suggested->threshold, 2) : "none";
}

std::vector<AssessSection> sections_of(const Assessment& a) {
  std::vector<AssessSection> sections;
  if (!a.notes.empty()) sections.push_back({"Beware", a.notes, {}});
  sections.push_back(threshold_section(a));
  sections.push_back(part_section(a));
  sections.push_back(spread_section(a));
  sections.push_back(score_section(a));
  sections.push_back(limit_section(a));
  if (a.settings.moved) sections.push_back(motion_section(a));
  sections.push_back(frame_section(a));
  return sections;
}

std::string assessment_text(const Assessment& assessment) {
  std::string out;
  for (const AssessSection& section : sections_of(assessment)) {
    out += (out.empty() ? "" : "\n") + section.heading + "\n";
    for (const std::string& sentence : section.sentences) out += wrapped(sentence);
    TextTable table;
    for (const std::vector<std::string>& row : section.rows) table.row(row);
    if (section.rows.size() > 1) out += table.text();
  }
  return out;
}

}  // namespace binpick::app
