#include "binpick/diagnosis/diagnosis.hpp"

#include <algorithm>

#include "binpick/geometry/angle.hpp"
#include "diagnosis/oracle_start.hpp"
#include "search/tree_search.hpp"

namespace binpick {
namespace {

// Before it is aligned a pose has a template's errors; the coarse alignment leaves some to the
// fine.
constexpr double kTemplateLimits = 2, kCoarseLimits = 1.5;
constexpr double kTemplateAngleRad = 15 * kDegree;
constexpr double kTemplateShare = 0.1;  // of the diameter

// Notes at each checkpoint which of the known poses still have a follower.
class Tracer final : public StageObserver {
 public:
  Tracer(std::span<const ReferencePose> references, const ReferenceLimits& limits,
         std::span<ReferenceFinding> findings)
      : references_(references), limits_(limits), findings_(findings) {}

  void candidates(const SearchContext& context, int model_index, int depth, bool selected,
                  std::span<const Candidate> found) override {
    const ObjectModel& model = context.models[static_cast<std::size_t>(model_index)];
    const int step = depth - model.info().scan_depth;
    const std::size_t at = static_cast<std::size_t>(2 * step + (selected ? 1 : 0));
    for (std::size_t i = 0; i < references_.size(); ++i) {
      if (references_[i].model_index != model_index) continue;
      const NearCandidate near(model, references_[i], depth, context.pyramid);
      // Before selection the list is not sorted: the place is that by score.
      std::uint16_t best = 0;
      for (const Candidate& c : found) {
        if (c.score > best && near(c)) best = c.score;
      }
      Sighting sighting;
      sighting.count = 0;
      int better = 0;
      for (const Candidate& c : found) {
        sighting.count += c.score > 0;
        better += c.score > best;
      }
      if (best > 0) sighting.place = better;
      findings_[i].sightings[at] = sighting;
    }
    models_ = context.models;
  }

  void hypotheses(Checkpoint checkpoint, std::span<const Hypothesis> list) override {
    for (std::size_t i = 0; i < references_.size(); ++i) {
      const int of = references_[i].model_index;
      const bool other =
          !list.empty() && std::none_of(list.begin(), list.end(),
                                        [&](const auto& h) { return h.candidate.model == of; });
      if (!other) sight(checkpoint, i, list);
    }
  }

  void finished(const ObservedCycle& cycle) override {
    hypotheses(Checkpoint::kAccepted, cycle.explained);
    const Scene scene(cycle.pyramid, cycle.kernels.pose);
    const auto owners = static_cast<int>(std::max<std::size_t>(1, cycle.explained.size()));
    Arena arena(Coverage::footprint(scene.depth.width, scene.depth.height, owners, 1));
    Coverage coverage(scene.depth.width, scene.depth.height, owners, 1, arena);
    for (std::size_t i = 0; i < references_.size(); ++i) {
      const auto& wanted = cycle.request.model_indices;
      const int of = references_[i].model_index;
      if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), of) == wanted.end()) continue;
      note_drop(cycle.explained, i);
      start_from_reference(cycle, references_[i], limits_, coverage, findings_[i]);
    }
  }

 private:
  bool near(Checkpoint checkpoint, std::size_t i, const Hypothesis& h) const {
    const ReferencePose& reference = references_[i];
    if (h.candidate.model != reference.model_index) return false;
    const ObjectModel& model = models_[h.candidate.model];
    double position_mm = limits_.position_mm, angle_rad = limits_.angle_rad;
    if (checkpoint < Checkpoint::kAlignedCoarse) {
      position_mm =
          std::max(kTemplateLimits * position_mm, kTemplateShare * model.info().diameter_mm);
      angle_rad = std::max(kTemplateLimits * angle_rad, kTemplateAngleRad);
    } else if (checkpoint < Checkpoint::kAlignedFine) {
      position_mm *= kCoarseLimits;
      angle_rad *= kCoarseLimits;
    }
    return reference_error(model, reference, h.T_cam_centre, position_mm, angle_rad) < 1;
  }

  void sight(Checkpoint checkpoint, std::size_t i, std::span<const Hypothesis> list) {
    Sighting sighting;
    sighting.count = 0;
    for (const Hypothesis& h : list) {
      if (!h.alive || h.candidate.model != references_[i].model_index) continue;
      if (!sighting.seen() && near(checkpoint, i, h)) sighting.place = sighting.count;
      ++sighting.count;
    }
    findings_[i].sightings[static_cast<std::size_t>(checkpoint)] = sighting;
  }

  void note_drop(std::span<const Hypothesis> explained, std::size_t i) {
    for (const Hypothesis& h : explained) {
      if (!near(Checkpoint::kAccepted, i, h)) continue;
      findings_[i].last_drop = h.drop_reason;
      findings_[i].last_score = h.score;
      return;
    }
  }

  std::span<const ReferencePose> references_;
  const ReferenceLimits& limits_;
  std::span<ReferenceFinding> findings_;
  std::span<const ObjectModel> models_;
};

}  // namespace

Result<DetectionReport> diagnose(Detector& detector, const Frame& frame,
                                 const DetectRequest& request,
                                 std::span<const ReferencePose> references,
                                 const ReferenceLimits& limits,
                                 std::span<ReferenceFinding> findings) {
  BINPICK_ASSERT(references.size() == findings.size());
  for (const ReferencePose& r : references) BINPICK_ASSERT(!r.poses.empty());
  Tracer tracer(references, limits, findings);
  DetectRequest observed = request;
  observed.observer = &tracer;
  return detector.detect(frame, observed);
}

}  // namespace binpick
