// The report of an evaluation: one HTML page that carries everything it shows, so that it can be
// mailed or kept beside the results.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "eval/model_set.hpp"
#include "eval/run_summary.hpp"
#include "eval/score.hpp"

namespace binpick::app {

struct ReportPicture {
  std::string caption;
  std::vector<std::uint8_t> png;
};

struct ReportContent {
  std::string title;
  std::vector<std::pair<std::string, std::string>>
      facts;  // name, value: data set, options, machine
  ScoreReport score;
  std::vector<RunLine> lines;
  std::vector<ModelOrigin> models;
  std::vector<std::string> faults;
  std::vector<ReportPicture> pictures, fault_pictures;
  std::string reach, causes;  // sections of the account of faults; may be empty
  std::string reliability;    // section of the score as a probability; may be empty
  std::string curves;         // section of the sweep; may be empty
};

std::string report_html(const ReportContent& content);

}  // namespace binpick::app
