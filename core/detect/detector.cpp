#include "binpick/detect/detector.hpp"

#include <algorithm>
#include <cmath>

#include "base/stopwatch.hpp"
#include "binpick/base/arena_plan.hpp"
#include "detect/detection_of.hpp"
#include "detect/detector_plan.hpp"
#include "detect/stage_observer.hpp"
#include "pose/alternatives.hpp"
#include "pose/score_candidates.hpp"
#include "pose/select.hpp"
#include "search/tree_search.hpp"

namespace binpick {
namespace {

// Of the time up to a deadline; the rest is for the poses.
constexpr double kSearchShare = 0.6;

// Best score first; ties are broken by the pose, so that the order is always the same.
bool better_detection(const Detection& a, const Detection& b) {
  if (a.score != b.score) return a.score > b.score;
  if (a.model_index != b.model_index) return a.model_index < b.model_index;
  return std::lexicographical_compare(a.T_cam_obj.t_mm.data(), a.T_cam_obj.t_mm.data() + 3,
                                      b.T_cam_obj.t_mm.data(), b.T_cam_obj.t_mm.data() + 3);
}

}  // namespace

struct Detector::Impl {
  Impl(std::span<const ObjectModel> models_in, const DetectorPlan& plan_in,
       const DetectorParams& params_in, WorkerPool& pool_in, ClockFn clock_in, Arena& arena)
      : models(models_in),
        plan(plan_in),
        params(params_in),
        pool(pool_in),
        clock(clock_in),
        kernels(simd::make_kernel_table(params_in.isa)),
        pyramid(plan.pyramid, arena),
        search(plan.search, plan.search_params, arena),
        selector(plan.selector(pool.thread_count()), arena),
        scale_plans(arena.take<ScalePlan>(models.size())),
        symmetries(arena.take<SymmetryTransforms>(models.size())),
        candidates(arena.take<Hypothesis>(plan.candidates_max())),
        hypotheses(arena.take<Hypothesis>(kHypothesesMax)),
        detections(arena.take<Detection>(static_cast<std::size_t>(plan.explained_max()))) {
    for (std::size_t i = 0; i < models.size(); ++i)
      symmetries[i] = SymmetryTransforms(models[i], arena);
  }

  Result<DetectionReport> detect(const Frame& frame, const DetectRequest& request);
  std::size_t search_model(int model_index, std::span<Hypothesis> out, const Deadline& deadline,
                           const DetectRequest& request, DetectionReport& report);
  std::size_t estimate_poses(std::size_t count, const Deadline& deadline,
                             const DetectRequest& request, DetectionReport& report);
  void explain(const Frame& frame, const DetectRequest& request, std::size_t count,
               DetectionReport& report);
  std::optional<RejectedPose> best_rejected(const PoseContext& context, std::size_t count) const;

  template <class Work>
  auto timed(Stage stage, DetectionReport& report, Work&& work) {
    struct Stop {
      Stopwatch watch;
      double& ms;
      ~Stop() { ms += watch.elapsed_ms(); }
    } const stop{Stopwatch(clock), report.stage_ms[static_cast<std::size_t>(stage)]};
    return work();
  }

  std::span<const ObjectModel> models;
  DetectorPlan plan;
  DetectorParams params;
  WorkerPool& pool;
  ClockFn clock;
  simd::KernelTable kernels;
  FeaturePyramid pyramid;
  TreeSearch search;
  Selector selector;
  std::span<ScalePlan> scale_plans;
  std::span<SymmetryTransforms> symmetries;  // of the models
  std::span<Hypothesis> candidates;          // all leaf candidates of one model
  std::span<Hypothesis> hypotheses;
  std::size_t looked_at = 0;  // of the hypotheses: those that lived last, or were dropped last
  std::span<Detection> detections;
};

std::size_t Detector::footprint(std::span<const ObjectModel> models, const DetectorLimits& limits,
                                const DetectorParams&, int thread_count) {
  const DetectorPlan plan = make_detector_plan(models, limits, thread_count);
  ArenaPlan counted;
  counted.take<Impl>(1);
  counted.take<ScalePlan>(models.size());
  counted.take<SymmetryTransforms>(models.size());
  counted.take<Hypothesis>(plan.candidates_max());
  counted.take<Hypothesis>(kHypothesesMax);
  counted.take<Detection>(static_cast<std::size_t>(plan.explained_max()));
  for (const ObjectModel& model : models) SymmetryTransforms::plan(model, counted);
  return counted.bytes + FeaturePyramid::footprint(plan.pyramid) +
         TreeSearch::footprint(plan.search, plan.search_params) +
         Selector::footprint(plan.selector(thread_count));
}

Detector::Detector(std::span<const ObjectModel> models, const DetectorLimits& limits,
                   const DetectorParams& params, WorkerPool& pool, ClockFn clock, Arena& arena) {
  struct alignas(Impl) Room {
    std::byte bytes[sizeof(Impl)];
  };
  impl_ = new (arena.take<Room>(1).data()) Impl(
      models, make_detector_plan(models, limits, pool.thread_count()), params, pool, clock, arena);
}

Detector::~Detector() {
  impl_->~Impl();
}

Result<DetectionReport> Detector::detect(const Frame& frame,
                                         const DetectRequest& request) noexcept {
  return impl_->detect(frame, request);
}

Result<DetectionReport> Detector::Impl::detect(const Frame& given, const DetectRequest& request) {
  const Stopwatch watch(clock);
  const Result<Frame> seen = seen_with(given, request.modality);
  if (!seen.ok()) return seen.error();
  const Frame& frame = seen.value();
  const Deadline deadline{clock, request.deadline_ns};
  const Result<Roi> region = region_of(frame, plan);
  if (!region.ok()) return region.error();
  const std::size_t wanted =
      request.model_indices.empty() ? models.size() : request.model_indices.size();
  const auto model_of = [&](std::size_t i) {
    return request.model_indices.empty() ? static_cast<int>(i) : request.model_indices[i];
  };
  int finest = kPyramidLevelsMax;
  for (std::size_t i = 0; i < wanted; ++i) {
    const int m = model_of(i);
    if (m < 0 || m >= static_cast<int>(models.size()))
      return Error{ErrorCode::kModelIndexUnknown, m, "request"};
    const ObjectModel& model = models[static_cast<std::size_t>(m)];
    const Result<ScalePlan> scale = make_scale_plan(model, frame.camera, plan.pyramid.level_count);
    if (!scale.ok()) return scale.error();
    scale_plans[static_cast<std::size_t>(m)] = scale.value();
    finest = std::min(finest, finest_level(model, scale.value()));
  }
  DetectionReport report;
  timed(Stage::kPyramid, report,
        [&] { pyramid.build(frame, region.value(), plan.normal_codebook, kernels, pool, finest); });
  const std::size_t room = std::min(kHypothesesPerModel, kHypothesesMax / wanted);
  const Deadline search_end = deadline.after_share(kSearchShare);
  std::size_t found = 0;
  for (std::size_t i = 0; i < wanted; ++i) {
    found +=
        search_model(model_of(i), hypotheses.subspan(found, room), search_end, request, report);
    report.cut_short |= search_end.passed();
  }
  found = estimate_poses(found, deadline, request, report);
  report.cut_short |= report.dropped[static_cast<int>(DropReason::kDeadline)] > 0;
  explain(frame, request, found, report);
  report.total_ms = watch.elapsed_ms();
  if (request.observer) {
    request.observer->finished({frame, request, report, models, symmetries, scale_plans, pyramid,
                                kernels, hypotheses.first(found)});
  }
  return report;
}

// The hypotheses of one model, into `out`; returns how many.
std::size_t Detector::Impl::search_model(int model_index, std::span<Hypothesis> out,
                                         const Deadline& deadline, const DetectRequest& request,
                                         DetectionReport& report) {
  const SearchContext context{models, scale_plans, pyramid,  kernels,         params.layout,
                              pool,   clock,       deadline, request.observer};
  report.level_count =
      std::max(report.level_count, models[static_cast<std::size_t>(model_index)].depth_count());
  const Scene scene(pyramid, kernels.pose);
  const PoseContext poses{models, symmetries, scene, pool, deadline};
  const std::span<const Candidate> leaves = search.run(context, model_index, report);
  const std::span<Hypothesis> scored = candidates.first(leaves.size());
  timed(Stage::kScore, report, [&] { score_candidates(poses, leaves, pyramid, scored); });
  const std::size_t count = timed(Stage::kSelect, report, [&] {
    return selector.suppress(poses, scored, limits_of_candidates(out.size()), out, report);
  });
  if (request.observer) {
    request.observer->hypotheses(Checkpoint::kScored, scored);
    request.observer->hypotheses(Checkpoint::kScoreSelected, out.first(count));
  }
  return count;
}

std::size_t Detector::Impl::estimate_poses(std::size_t count, const Deadline& deadline,
                                           const DetectRequest& request, DetectionReport& report) {
  const Scene scene(pyramid, kernels.pose);
  looked_at = count;
  // Each step may use the time up to its share of what is left now: were one to use up all, no pose
  // would be finished. The shares are those of an unhurried run.
  auto until = [&](double share) {
    return PoseContext{models, symmetries, scene, pool, deadline.after_share(share)};
  };
  auto living = [&] { return hypotheses.first(count); };
  auto observe = [&](Checkpoint checkpoint) {
    if (request.observer) request.observer->hypotheses(checkpoint, living());
  };
  const PoseContext coarse_end = until(0.3), checked = until(0.4), fine_end = until(0.7),
                    end = until(1);
  auto align = [&](std::span<const AlignStep> schedule, std::span<Hypothesis> list,
                   const PoseContext& step_end) {
    timed(Stage::kAlign, report, [&] { align_all(step_end, schedule, list); });
  };
  auto verify = [&](std::span<Hypothesis> list, const PoseContext& step_end) {
    timed(Stage::kVerify, report, [&] { verify_all(step_end, list); });
  };
  auto suppress = [&](const SuppressLimits& limits) {
    count = timed(Stage::kSelect, report,
                  [&] { return selector.suppress(end, living(), limits, report); });
    if (count > 0) looked_at = count;
  };
  align(coarse_alignment(scene), living(), coarse_end);
  suppress(limits_of_duplicates());  // half of them by now; spared the verification
  verify(living(), checked);
  observe(Checkpoint::kAlignedCoarse);
  suppress(limits_of_aligned());
  timed(Stage::kSelect, report, [&] { selector.prune(end, living()); });
  observe(Checkpoint::kCoarseSelected);
  align(fine_alignment(scene), living(), fine_end);
  verify(living(), end);
  observe(Checkpoint::kAlignedFine);
  suppress(limits_of_aligned());
  const std::size_t found = count;
  count =
      timed(Stage::kAlternatives, report, [&] { return add_alternatives(end, hypotheses, found); });
  align(fine_alignment(scene), living().subspan(found), end);
  verify(living().subspan(found), end);
  suppress(limits_of_aligned());
  observe(Checkpoint::kFineSelected);
  return count;
}

void Detector::Impl::explain(const Frame& frame, const DetectRequest& request, std::size_t count,
                             DetectionReport& report) {
  const Scene scene(pyramid, kernels.pose);
  const PoseContext context{models, symmetries, scene, pool, {}, request.near_symmetry};
  const std::span<Hypothesis> living = hypotheses.first(count);
  for (Hypothesis& h : living)
    h.alive = h.alive && centre_inside_roi(frame, pyramid.region(), h.T_cam_centre, scene);
  std::size_t accepted = 0;
  timed(Stage::kSelect, report, [&] {
    for (const Hypothesis* h : selector.explain(context, living, request.min_score, report))
      detections[accepted++] = detection_of(context, *h);
  });
  std::sort(detections.begin(), detections.begin() + static_cast<std::ptrdiff_t>(accepted),
            better_detection);
  const auto limit = static_cast<std::size_t>(std::clamp(request.max_results, 0, plan.results_max));
  if (accepted > limit) {
    report.dropped[static_cast<std::size_t>(DropReason::kResultLimit)] +=
        static_cast<int>(accepted - limit);
  }
  report.detections = detections.first(std::min(accepted, limit));
  if (accepted == 0) report.best_rejected = best_rejected(context, looked_at);
}

// What came nearest to a detection: of the hypotheses that were dropped last the one with the
// highest score, the first of equals. One that overlaps a better one counts with it, and none
// outside the region of interest (dropped without a reason of its own).
std::optional<RejectedPose> Detector::Impl::best_rejected(const PoseContext& context,
                                                          std::size_t count) const {
  const Hypothesis* best = nullptr;
  for (const Hypothesis& h : hypotheses.first(count)) {
    if (h.alive || h.drop_reason == DropReason::kOverlapsBetter ||
        h.drop_reason == DropReason::kDuplicate)
      continue;
    if (best == nullptr || h.score > best->score) best = &h;
  }
  if (best == nullptr) return std::nullopt;
  return RejectedPose{detection_of(context, *best), best->drop_reason};
}

}  // namespace binpick
