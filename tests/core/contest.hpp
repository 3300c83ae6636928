// Hypotheses of one bracket that compete for its pixels.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "binpick/geometry/angle.hpp"
#include "pose/select.hpp"
#include "seen_bracket.hpp"

namespace binpick {

inline constexpr int kOwners = 4;

inline Pose turned(const Pose& T, double deg) {
  return left_increment(T, Vec3(0, 0, deg * kDegree), Vec3::Zero(), T.t_mm);
}

struct Contest {
  explicit Contest(const ObjectModel& part = bracket_model(), bool with_depth = true)
      : bracket(bracket_pose(30, 40, 10, Vec3(5, -5, 500)), part),
        limits{bracket.plan.width_max, bracket.plan.height_max, kOwners, 200, 100, 1},
        arena(Selector::footprint(limits)),
        selector(limits, arena) {
    EXPECT_EQ(arena.size_bytes(), arena.used_bytes());
    if (!with_depth) bracket.without_depth();
  }

  // At the truth, moved sideways.
  Hypothesis pose(double shift_mm, double rank = 0) const {
    Hypothesis h;
    h.T_cam_centre = bracket.truth;
    h.T_cam_centre.t_mm.x() += shift_mm;
    h.score = h.rank = rank;
    return h;
  }
  Hypothesis verified(const Pose& T) {
    Hypothesis h;
    h.T_cam_centre = T;
    const Scene scene = bracket.scene();
    verify_one(bracket.context(scene), h);
    return h;
  }

  std::vector<Hypothesis> suppressed(const std::vector<Hypothesis>& from,
                                     const SuppressLimits& by = limits_of_aligned(),
                                     std::size_t room = 100) {
    std::vector<Hypothesis> out(room);
    const Scene scene = bracket.scene();
    report = {};
    out.resize(selector.suppress(bracket.context(scene), from, by, out, report));
    return out;
  }
  std::vector<Hypothesis*> explained(std::vector<Hypothesis>& list, double min_score = 0) {
    const Scene scene = bracket.scene();
    report = {};
    const auto kept = selector.explain(bracket.context(scene), list, min_score, report);
    return {kept.begin(), kept.end()};
  }
  int dropped(DropReason reason) const { return report.dropped[static_cast<std::size_t>(reason)]; }

  SeenBracket bracket;
  SelectorLimits limits;
  Arena arena;
  Selector selector;
  DetectionReport report;
};

}  // namespace binpick
