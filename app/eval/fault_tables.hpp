// The account of faults as text, HTML and JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "eval/fault_analysis.hpp"

namespace binpick::app {

// What is reachable, a line a part; the false picks; then a line for each missed part.
std::string fault_table(const std::vector<PartFaults>& parts);

std::string reach_section_html(const std::vector<PartFaults>& parts);
// Every missed part and false pick with its cause.
std::string cause_section_html(const std::vector<PartFaults>& parts, const TruthByFrame& truth,
                               const std::vector<ResultRow>& rows);

nlohmann::json faults_to_json(const std::vector<PartFaults>& parts,
                              const std::vector<ResultRow>& rows);

}  // namespace binpick::app
