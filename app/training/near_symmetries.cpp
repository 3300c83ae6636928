#include "training/near_symmetries.hpp"

#include <algorithm>

namespace binpick::app {
namespace {

constexpr double kTurnedShareMax = 0.2;
constexpr int kTurnedMin = 3;  // fewer may be chance
constexpr double kVisibleMin = 0.5;

struct Counts {
  int right = 0, turned = 0;

  bool indistinguishable() const {
    return turned >= kTurnedMin && turned > kTurnedShareMax * (right + turned);
  }
};

// Symmetries of a part, as those who judge poses know them.
class SymmetryList {
 public:
  explicit SymmetryList(const ObjectModel& model) : model_(model) {
    part_.obj_id = kPileObject;
    part_.diameter_mm = model.info().diameter_mm;
    for (const SymmetryTurn& turn : model.symmetry().exact_turns) add(turn);
    for (const SymmetryAxis& axis : model.symmetry().exact_axes) add(axis);
  }
  // Followed by each that is there already: together they are symmetries too.
  void add(const SymmetryTurn& turn) {
    std::vector<Pose>& all = part_.symmetries_discrete;
    const Pose move = in_cad(move_of(turn), model_.centre_mm());
    const std::size_t count = all.size();
    all.push_back(move);
    if (turn.kind == SymmetryKind::kExact) return;  // these are a group
    for (std::size_t i = 0; i < count; ++i) all.push_back(move * all[i]);
  }
  void add(const SymmetryAxis& axis) {
    part_.symmetries_continuous.push_back(
        {vector_of(axis.axis), vector_of(axis.point_mm) + model_.centre_mm()});
  }
  PartGeometry geometry(const train::Mesh& mesh) const { return PartGeometry(part_, mesh); }

 private:
  const ObjectModel& model_;
  drivers::BopModel part_;
};

// Of the best rows at the parts: those that are right, and those that only `up_to` makes right.
Counts count(const PileTrial& trial, const PartGeometry& exact, const PartGeometry& up_to,
             const PoseLimits& limits) {
  Counts counts;
  for (const auto& [id, instances] : trial.truth) {
    for (const ScoredInstance& instance : instances) {
      if (!instance.origin_in_roi || instance.truth.visible_fraction < kVisibleMin) continue;
      const Pose& truth = instance.truth.T_cam_obj;
      const ResultRow* best = nullptr;
      for (const ResultRow& row : trial.rows) {
        if (row.frame == id && (best == nullptr || row.score > best->score) &&
            is_right(up_to, row.T_cam_obj, truth, limits))
          best = &row;
      }
      if (best == nullptr) continue;
      const bool right = is_right(exact, best->T_cam_obj, truth, limits);
      ++(right ? counts.right : counts.turned);
    }
  }
  return counts;
}

}  // namespace

PartGeometry geometry_of(const ObjectModel& model, const train::Mesh& mesh) {
  SymmetryList list(model);
  for (const SymmetryTurn& turn : model.symmetry().near_turns)
    if (turn.kind == SymmetryKind::kIndistinguishable) list.add(turn);
  for (const SymmetryAxis& axis : model.symmetry().near_axes)
    if (axis.kind == SymmetryKind::kIndistinguishable) list.add(axis);
  return list.geometry(mesh);
}

train::NearSymmetries indistinguishable_symmetries(const PileTrial& trial, const ObjectModel& model,
                                                   const train::Mesh& mesh,
                                                   const PoseLimits& limits) {
  const PartGeometry exact = SymmetryList(model).geometry(mesh);
  const auto judge = [&](const auto& near) {
    SymmetryList list(model);
    list.add(near);
    return count(trial, exact, list.geometry(mesh), limits).indistinguishable();
  };
  train::NearSymmetries which;
  for (const SymmetryTurn& turn : model.symmetry().near_turns) which.turns.push_back(judge(turn));
  for (const SymmetryAxis& axis : model.symmetry().near_axes) which.axes.push_back(judge(axis));
  return which;
}

}  // namespace binpick::app
