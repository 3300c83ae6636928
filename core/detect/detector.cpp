#include "binpick/detect/detector.hpp"

#include <algorithm>
#include <cmath>

#include "base/stopwatch.hpp"
#include "binpick/base/arena_plan.hpp"
#include "detect/acceptance.hpp"
#include "detect/detector_plan.hpp"
#include "detect/stage_observer.hpp"
#include "pose/claims.hpp"
#include "pose/hypothesis.hpp"
#include "pose/loose_turns.hpp"
#include "pose/near_poses.hpp"
#include "pose/rivals.hpp"
#include "pose/screen.hpp"
#include "pose/set_aside.hpp"
#include "search/tree_search.hpp"

namespace binpick {
namespace {

constexpr int kPerPlaceAfterIcp = 6;
// What is less probable than this owns nothing, and is no rival.
constexpr double kScoreToExplain = 0.001;
// Of the time up to a deadline; the rest is for the poses.
constexpr double kSearchShare = 0.6;

// Best score first; ties are broken by the pose, so that the order is always the same.
bool better_detection(const Detection& a, const Detection& b) {
  if (a.score != b.score) return a.score > b.score;
  if (a.model_index != b.model_index) return a.model_index < b.model_index;
  return std::lexicographical_compare(a.T_cam_obj.t_mm.data(), a.T_cam_obj.t_mm.data() + 3,
                                      b.T_cam_obj.t_mm.data(), b.T_cam_obj.t_mm.data() + 3);
}

// The finest level that a model is searched at.
int finest_level(const ObjectModel& model, const ScalePlan& plan) {
  int finest = kPyramidLevelsMax;
  for (int d = model.info().scan_depth; d < model.depth_count(); ++d) {
    for (int k = 0; k < model.depth(d).distance_count; ++k) {
      if (plan.level[d][k] >= 0) finest = std::min<int>(finest, plan.level[d][k]);
    }
  }
  return finest;
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
        claims(plan.pyramid.width_max >> kFeatureLevel, plan.pyramid.height_max >> kFeatureLevel,
               plan.explained_max(), pool.thread_count(), arena),
        scale_plans(arena.take<ScalePlan>(models.size())),
        moves(arena.take<PartMoves>(models.size())),
        screening(arena.take<Hypothesis>(plan.screening_max())),
        hypotheses(arena.take<Hypothesis>(kHypothesesMax)),
        detections(arena.take<Detection>(static_cast<std::size_t>(plan.explained_max()))) {
    for (std::size_t i = 0; i < models.size(); ++i) moves[i] = PartMoves(models[i], arena);
  }

  Result<DetectionReport> detect(const Frame& frame, const DetectRequest& request);
  int search_model(int model_index, std::size_t room, int found, const Deadline& deadline,
                   const DetectRequest& request, DetectionReport& report);
  int estimate_poses(int count, const Deadline& deadline, const DetectRequest& request,
                     DetectionReport& report);
  void explain(const Frame& frame, const DetectRequest& request, int count,
               DetectionReport& report);

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
  Claims claims;  // on pixels of the scene
  std::span<ScalePlan> scale_plans;
  std::span<PartMoves> moves;       // of the models' symmetries
  std::span<Hypothesis> screening;  // all leaf candidates of one model
  std::span<Hypothesis> hypotheses;
  std::span<Detection> detections;
};

std::size_t Detector::footprint(std::span<const ObjectModel> models, const DetectorLimits& limits,
                                const DetectorParams&, int thread_count) {
  const DetectorPlan plan = make_detector_plan(models, limits, thread_count);
  ArenaPlan counted;
  counted.take<Impl>(1);
  counted.take<ScalePlan>(models.size());
  counted.take<PartMoves>(models.size());
  counted.take<Hypothesis>(plan.screening_max());
  counted.take<Hypothesis>(kHypothesesMax);
  counted.take<Detection>(static_cast<std::size_t>(plan.explained_max()));
  for (const ObjectModel& model : models) PartMoves::plan(model, counted);
  return counted.bytes + FeaturePyramid::footprint(plan.pyramid) +
         TreeSearch::footprint(plan.search, plan.search_params) +
         Claims::footprint(plan.pyramid.width_max >> kFeatureLevel,
                           plan.pyramid.height_max >> kFeatureLevel, plan.explained_max(),
                           thread_count);
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
  const int wanted = request.model_indices.empty() ? static_cast<int>(models.size())
                                                   : static_cast<int>(request.model_indices.size());
  const auto model_of = [&](int i) {
    return request.model_indices.empty() ? i : request.model_indices[static_cast<std::size_t>(i)];
  };
  int finest = kPyramidLevelsMax;
  for (int i = 0; i < wanted; ++i) {
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
  const Deadline search_end = deadline.after_share(kSearchShare);
  int found = 0;
  for (int i = 0; i < wanted; ++i) {
    found = search_model(
        model_of(i),
        std::min(kHypothesesPerModel, kHypothesesMax / static_cast<std::size_t>(wanted)), found,
        search_end, request, report);
    report.cut_short |= search_end.passed();
  }
  found = estimate_poses(found, deadline, request, report);
  report.cut_short |= report.dropped[static_cast<int>(DropReason::kDeadline)] > 0;
  timed(Stage::kExplain, report, [&] { explain(frame, request, found, report); });
  report.total_ms = watch.elapsed_ms();
  if (request.observer) {
    request.observer->finished({frame, request, report, models, moves, scale_plans, pyramid,
                                kernels, hypotheses.first(static_cast<std::size_t>(found))});
  }
  return report;
}

// Appends the hypotheses of one model, at most `room`, to the `found` ones before.
int Detector::Impl::search_model(int model_index, std::size_t room, int found,
                                 const Deadline& deadline, const DetectRequest& request,
                                 DetectionReport& report) {
  const SearchContext context{models, scale_plans, pyramid,  kernels,         params.layout,
                              pool,   clock,       deadline, request.observer};
  report.level_count =
      std::max(report.level_count, models[static_cast<std::size_t>(model_index)].depth_count());
  const Scene scene(pyramid);
  const std::span<const Candidate> leaves = search.run(context, model_index, report);
  const std::span<Hypothesis> out = hypotheses.subspan(static_cast<std::size_t>(found), room);
  const int count = timed(Stage::kScreen, report, [&] {
    return screen_candidates({models, moves, scene, pool, deadline}, leaves, pyramid, screening,
                             out, report);
  });
  if (request.observer) {
    request.observer->hypotheses(Checkpoint::kScreened, screening.first(leaves.size()));
    request.observer->hypotheses(Checkpoint::kScreenSelected,
                                 out.first(static_cast<std::size_t>(count)));
  }
  return found + count;
}

int Detector::Impl::estimate_poses(int count, const Deadline& deadline,
                                   const DetectRequest& request, DetectionReport& report) {
  const Scene scene(pyramid);
  // Each stage may use the time up to its share of what is left now: were one to use up all, no
  // pose would be finished. The shares are those of an unhurried run.
  auto until = [&](double share) {
    return PoseContext{models, moves, scene, pool, deadline.after_share(share)};
  };
  const PoseContext lead_end = until(0.12), pnp_end = until(0.2), icp_end = until(0.4),
                    check_end = until(0.5), refine_end = until(0.75), end = until(1);
  auto living = [&] { return hypotheses.first(static_cast<std::size_t>(count)); };
  auto observe = [&](Checkpoint checkpoint) {
    if (request.observer) request.observer->hypotheses(checkpoint, living());
  };
  auto drop_repeated = [&] {
    count = timed(Stage::kSuppress, report,
                  [&] { return suppress(end, living(), kPerPlaceAfterIcp, report); });
  };
  // The best at each place first: what these explain beyond doubt is spared the others.
  const std::size_t leaders = leaders_to_front(end, living());
  const std::span<Hypothesis> leading = living().first(leaders), others = living().subspan(leaders);
  timed(Stage::kPnp, report, [&] { run_pnp(lead_end, leading); });
  timed(Stage::kIcp, report, [&] { run_icp(lead_end, leading); });
  timed(Stage::kVerify, report, [&] { run_verify(lead_end, leading); });
  timed(Stage::kSuppress, report, [&] { set_aside_explained(end, claims, leading, others); });
  observe(Checkpoint::kUnexplained);
  timed(Stage::kPnp, report, [&] { run_pnp(pnp_end, others); });
  observe(Checkpoint::kPnp);
  timed(Stage::kIcp, report, [&] { run_icp(icp_end, others); });
  observe(Checkpoint::kIcp);
  timed(Stage::kVerify, report, [&] { run_verify(check_end, others); });
  drop_repeated();
  timed(Stage::kSuppress, report, [&] { set_aside_outdone(end, claims, living()); });
  observe(Checkpoint::kIcpSelected);
  timed(Stage::kRefine, report, [&] { run_refine(refine_end, living()); });
  observe(Checkpoint::kRefined);
  timed(Stage::kVerify, report, [&] { run_verify(end, living()); });
  drop_repeated();
  count = timed(Stage::kVerify, report, [&] { return add_loose_turns(end, hypotheses, count); });
  drop_repeated();
  const SettleOutcome settled =
      timed(Stage::kVerify, report, [&] { return settle_near_poses(end, living()); });
  report.cut_short |= settled.cut_short;
  if (settled.changed) drop_repeated();
  observe(Checkpoint::kRefinedSelected);
  return count;
}

// In the order of what they explain, whatever score is asked for: what is kept of the poses must
// not depend on what is shown of them.
void Detector::Impl::explain(const Frame& frame, const DetectRequest& request, int count,
                             DetectionReport& report) {
  const Scene scene(pyramid);
  const PoseContext context{models, moves, scene, pool, {}};
  const std::span<Hypothesis> living = hypotheses.first(static_cast<std::size_t>(count));
  auto drop = [&](Hypothesis& h, DropReason reason) {
    h.drop(reason);
    count_drop(report, reason);
  };
  claims.clear(scene);
  for (Hypothesis& h : living) {
    if (!centre_inside_roi(frame, pyramid.region(), h.T_cam_centre, scene)) {
      h.alive = false;
    } else if (const auto objection =
                   objection_to(h, std::min(kScoreToExplain, request.min_score))) {
      drop(h, *objection);
    } else if (Hypothesis* owner = claims.owner_of(context, h)) {
      meet_rival(context, *owner, h);
      drop(h, DropReason::kOverlapsBetter);
    } else if (!claims.add(context, h)) {
      drop(h, DropReason::kResultLimit);
    }
  }
  std::size_t accepted = 0;
  for (Hypothesis* h : claims.owners()) {
    score_beside_rivals(context, *h);
    if (h->score < request.min_score) {
      drop(*h, DropReason::kBelowMinScore);
    } else {
      detections[accepted++] = detection_of(models, scene, *h);
    }
  }
  std::sort(detections.begin(), detections.begin() + static_cast<std::ptrdiff_t>(accepted),
            better_detection);
  const auto limit = static_cast<std::size_t>(std::clamp(request.max_results, 0, plan.results_max));
  if (accepted > limit) {
    report.dropped[static_cast<std::size_t>(DropReason::kResultLimit)] +=
        static_cast<int>(accepted - limit);
  }
  report.detections = detections.first(std::min(accepted, limit));
}

}  // namespace binpick
