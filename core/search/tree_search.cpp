#include "search/tree_search.hpp"

#include <algorithm>
#include <cmath>

#include "base/stopwatch.hpp"
#include "binpick/base/arena_plan.hpp"

namespace binpick {
namespace {

// The scan may hand over more candidates than survive: all cells' best.
constexpr std::size_t kScanOutputMax = 60000;
constexpr int kPlacePxMin = 8;

int place_px(const ObjectModel& model, const CameraIntrinsics& camera) {
  const double diameter_px = std::sqrt(camera.fx * camera.fy) * model.info().diameter_mm /
                             ((model.info().distance_min_mm + model.info().distance_max_mm) / 2);
  return std::max(kPlacePxMin, static_cast<int>(diameter_px / 5));
}

}  // namespace

template <class Source>
TreeSearch::Buffers TreeSearch::take(const SearchLimits& limits, const SearchParams& params,
                                     Source& source) {
  const std::size_t parents_max =
      static_cast<std::size_t>(*std::max_element(params.candidates_max, params.candidates_max + 4));
  const std::size_t found_max = std::max(kScanOutputMax, parents_max * kChildrenKept);
  Buffers b;
  b.found = source.template take<Candidate>(found_max);
  b.selected = source.template take<Candidate>(found_max);
  b.select.places = source.template take<PlaceCount>(
      static_cast<std::size_t>(limits.region_width_max / kPlacePxMin + 1) *
      static_cast<std::size_t>(limits.region_height_max / kPlacePxMin + 1));
  b.select.score_starts = source.template take<std::uint32_t>(kScoresMax + 1);
  b.by_node.starts =
      source.template take<std::uint32_t>(static_cast<std::size_t>(limits.nodes_max) + 1);
  b.by_node.order = source.template take<std::uint32_t>(parents_max);
  return b;
}

std::size_t TreeSearch::footprint(const SearchLimits& limits, const SearchParams& params) {
  ArenaPlan plan;
  take(limits, params, plan);
  return plan.bytes + Scanner::footprint(limits.scan);
}

TreeSearch::TreeSearch(const SearchLimits& limits, const SearchParams& params, Arena& arena)
    : params_(params), scanner_(limits.scan, arena), buffers_(take(limits, params, arena)) {}

std::span<const Candidate> TreeSearch::run(const SearchContext& context, int model_index,
                                           DetectionReport& report) {
  const ObjectModel& model = context.models[static_cast<std::size_t>(model_index)];
  const ScalePlan& plan = context.plans[static_cast<std::size_t>(model_index)];
  const int scan_depth = model.info().scan_depth;
  const double score_min =
      context.pyramid.with_depth() ? params_.score_min : params_.gradient_score_min;
  const int threshold = static_cast<int>(score_min * kScoreOne);
  const int place = place_px(model, context.pyramid.level(0).camera);
  const auto observe = [&](int depth, bool selected, std::span<const Candidate> found) {
    if (context.observer)
      context.observer->candidates(context, model_index, depth, selected, found);
  };
  int& below_limit = report.dropped[static_cast<int>(DropReason::kLevelLimit)];
  const auto select = [&](std::span<const Candidate> found, int step) {
    const SelectLimits within{params_.candidates_max[step], params_.per_place_max[step],
                              params_.per_origin_max[step], step};
    const int kept = select_candidates(found, buffers_.selected, within, place,
                                       context.pyramid.region(), buffers_.select, below_limit);
    return buffers_.selected.first(static_cast<std::size_t>(kept));
  };

  const Stopwatch scan_watch(context.clock);
  std::size_t count = 0;
  for (int k = 0; k < model.depth(scan_depth).distance_count; ++k) {
    if (plan.level[scan_depth][k] < 0) continue;
    if (context.deadline.passed()) return {};
    count += static_cast<std::size_t>(scanner_.scan(
        model, model_index, k, plan, context.pyramid, context.kernels, threshold, context.pool,
        buffers_.found.first(kScanOutputMax).subspan(count), below_limit));
    const PyramidLevel& level = context.pyramid.level(plan.level[scan_depth][k]);
    report.templates_evaluated[static_cast<std::size_t>(scan_depth)] +=
        static_cast<std::int64_t>(model.depth(scan_depth).templates.size()) * level.width *
        level.height / 16;
  }
  observe(scan_depth, false, buffers_.found.first(count));
  std::span<const Candidate> living = select(buffers_.found.first(count), 0);
  observe(scan_depth, true, living);
  report.candidates[static_cast<std::size_t>(scan_depth)] += static_cast<int>(living.size());
  const double scan_ms = scan_watch.elapsed_ms();
  report.level_ms[static_cast<std::size_t>(scan_depth)] += scan_ms;
  report.stage_ms[static_cast<int>(Stage::kScan)] += scan_ms;

  for (int d = scan_depth + 1; d < model.depth_count(); ++d) {
    if (context.deadline.passed()) return {};
    const Stopwatch watch(context.clock);
    const DescendContext descend_context{context.models,  context.plans,  context.pyramid,
                                         context.kernels, context.layout, threshold};
    const std::span<Candidate> children = buffers_.found.first(living.size() * kChildrenKept);
    const DescendCounts counts =
        descend(descend_context, d, living, children, buffers_.by_node, context.pool);
    report.templates_evaluated[static_cast<std::size_t>(d)] += counts.templates_matched;
    report.dropped[static_cast<int>(DropReason::kBelowMatchThreshold)] += counts.parents_ended;
    report.level_ms[static_cast<std::size_t>(d)] += watch.elapsed_ms();
    observe(d, false, children);
    living = select(children, d - scan_depth);
    observe(d, true, living);
    report.candidates[static_cast<std::size_t>(d)] += static_cast<int>(living.size());
    report.stage_ms[static_cast<int>(Stage::kDescend)] += watch.elapsed_ms();
  }
  return living;
}

}  // namespace binpick
