// Overlays of the worst frames of an evaluation, ready for its report.
#pragma once

#include <vector>

#include "eval/eval_plan.hpp"
#include "eval/part_library.hpp"
#include "eval/report_html.hpp"

namespace binpick::app {

// Reads the frames again and draws on them what was right, wrong and missed; a frame that cannot be
// read is left out. Throws RenderError.
std::vector<ReportPicture> worst_pictures(const drivers::BopDataset& dataset, const EvalPlan& plan,
                                          const PartLibrary& parts, const ScoreReport& score,
                                          const std::vector<ResultRow>& rows,
                                          std::size_t count_max);

}  // namespace binpick::app
