#include "search/tree_search.hpp"

#include <algorithm>
#include <cmath>

#include "base/arena_plan.hpp"

namespace binpick {
namespace {

// The scan may hand over more candidates than survive: all cells' best.
constexpr std::size_t kScanOutputMax = 60000;

int place_px(const ObjectModel& model, const CameraIntrinsics& camera) {
  const double diameter_px = std::sqrt(camera.fx * camera.fy) * model.info().diameter_mm /
                             ((model.info().distance_min_mm + model.info().distance_max_mm) / 2);
  return std::max(kPlacePxMin, static_cast<int>(diameter_px / 5));
}

double milliseconds_since(ClockFn clock, std::int64_t start_ns) {
  return clock ? static_cast<double>(clock() - start_ns) * 1e-6 : 0;
}

}  // namespace

template <class Source>
void TreeSearch::take(const SearchLimits& limits, const SearchParams& params, Source& source) {
  const std::size_t parents_max =
      static_cast<std::size_t>(*std::max_element(params.candidates_max, params.candidates_max + 4));
  candidates_ = source.template take<Candidate>(kScanOutputMax);
  children_ = source.template take<Candidate>(parents_max * kChildrenKept);
  places_ = source.template take<std::uint16_t>(
      static_cast<std::size_t>(limits.region_width_max / kPlacePxMin + 1) *
      static_cast<std::size_t>(limits.region_height_max / kPlacePxMin + 1));
}

std::size_t TreeSearch::footprint(const SearchLimits& limits, const SearchParams& params) {
  ArenaPlan plan;
  Arena nothing(0);
  TreeSearch counted(SearchLimits{}, params, nothing);
  counted.take(limits, params, plan);
  return plan.bytes + Scanner::footprint(limits.scan);
}

TreeSearch::TreeSearch(const SearchLimits& limits, const SearchParams& params, Arena& arena)
    : params_(params), scanner_(limits.scan, arena) {
  if (limits.region_width_max > 0) take(limits, params, arena);
}

std::span<const Candidate> TreeSearch::run(const SearchContext& context, int model_index,
                                           DetectionReport& report) {
  const ObjectModel& model = context.models[static_cast<std::size_t>(model_index)];
  const ScalePlan& plan = context.plans[static_cast<std::size_t>(model_index)];
  const int scan_depth = model.info().scan_depth;
  const int threshold = static_cast<int>(params_.score_min * kScoreOne);
  const int place = place_px(model, context.pyramid.level(0).camera);
  int& below_limit = report.dropped[static_cast<int>(DropReason::kLevelLimit)];

  const std::int64_t scan_start = context.clock ? context.clock() : 0;
  int count = 0;
  for (int k = 0; k < model.depth(scan_depth).distance_count; ++k) {
    if (plan.level[scan_depth][k] < 0) continue;
    count += scanner_.scan(model, model_index, k, plan, context.pyramid, context.kernels, threshold,
                           context.pool, candidates_.subspan(static_cast<std::size_t>(count)),
                           below_limit);
    const PyramidLevel& level = context.pyramid.level(plan.level[scan_depth][k]);
    report.templates_evaluated[static_cast<std::size_t>(scan_depth)] +=
        static_cast<std::int64_t>(model.depth(scan_depth).templates.size()) * level.width *
        level.height / 16;
  }
  count = select_candidates(candidates_.first(static_cast<std::size_t>(count)),
                            params_.candidates_max[0], params_.per_place_max[0], place,
                            context.pyramid.region(), places_, below_limit);
  report.candidates[static_cast<std::size_t>(scan_depth)] += count;
  const double scan_ms = milliseconds_since(context.clock, scan_start);
  report.level_ms[static_cast<std::size_t>(scan_depth)] += scan_ms;
  report.stage_ms[static_cast<int>(Stage::kScan)] += scan_ms;

  for (int d = scan_depth + 1; d < model.depth_count(); ++d) {
    const std::int64_t start = context.clock ? context.clock() : 0;
    const DescendContext descend_context{context.models,  context.plans,  context.pyramid,
                                         context.kernels, context.layout, threshold};
    const std::span<Candidate> children =
        children_.first(static_cast<std::size_t>(count) * kChildrenKept);
    report.templates_evaluated[static_cast<std::size_t>(d)] +=
        descend(descend_context, d, candidates_.first(static_cast<std::size_t>(count)), children,
                context.pool);
    report.level_ms[static_cast<std::size_t>(d)] += milliseconds_since(context.clock, start);
    std::copy(children.begin(), children.end(), candidates_.begin());
    count = select_candidates(candidates_.first(children.size()),
                              params_.candidates_max[d - scan_depth],
                              params_.per_place_max[d - scan_depth], place,
                              context.pyramid.region(), places_, below_limit);
    report.candidates[static_cast<std::size_t>(d)] += count;
    report.stage_ms[static_cast<int>(Stage::kDescend)] += milliseconds_since(context.clock, start);
  }
  return candidates_.first(static_cast<std::size_t>(count));
}

}  // namespace binpick
