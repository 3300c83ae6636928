// Crops of what went wrong, ready for the report: the image beside itself with the true pose and
// the found one.
#pragma once

#include <vector>

#include "eval/eval_plan.hpp"
#include "eval/fault_analysis.hpp"
#include "eval/part_library.hpp"
#include "eval/report_html.hpp"

namespace binpick::app {

// One fault: a missed part, or a false pick.
struct Fault {
  const PartFaults* part = nullptr;
  const MissedPart* missed = nullptr;
  const FalsePick* wrong = nullptr;
};

// Of each part one fault of every cause first, then the rest; at most `count_max`. Points into
// `parts`.
std::vector<Fault> faults_to_show(const std::vector<PartFaults>& parts, std::size_t count_max);

// Reads the frames again; one that cannot be read is left out. Throws RenderError.
std::vector<ReportPicture> fault_pictures(const drivers::BopDataset& dataset, const EvalPlan& plan,
                                          const PartLibrary& library,
                                          const std::vector<PartFaults>& parts,
                                          const std::vector<ResultRow>& rows,
                                          std::size_t count_max);

}  // namespace binpick::app
