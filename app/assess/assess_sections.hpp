// What an assessment tells people, once for the console and the page: sections of sentences and one
// table each.
#pragma once

#include <string>
#include <vector>

#include "assess/assessment.hpp"

namespace binpick::app {

struct AssessSection {
  std::string heading;
  std::vector<std::string> sentences;
  std::vector<std::vector<std::string>> rows;  // the first is the heading; may be empty
};

std::vector<AssessSection> sections_of(const Assessment& assessment);

std::string assessment_text(const Assessment& assessment);

// "0.62", or why there is none.
std::string suggestion_text(const ModelAssessment& model);

}  // namespace binpick::app
