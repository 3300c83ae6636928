#include "eval/false_pick.hpp"

#include <cmath>

#include "eval/html_text.hpp"

namespace binpick::app {
namespace {

constexpr double kNearShare = 0.5;      // of the diameter, between origins
constexpr double kInPlaceShare = 0.15;  // of the diameter
constexpr double kFlippedDeg = 60;

}  // namespace

const char* false_pick_name(FalsePickKind kind) {
  static constexpr const char* kNames[kFalsePickKindCount] = {"repeated", "slid",   "turned",
                                                              "flipped",  "adrift", "clutter"};
  return kNames[static_cast<std::size_t>(kind)];
}

FalsePick classify_false_pick(const PartGeometry& part, int obj_id, const Pose& estimate,
                              const std::vector<ScoredInstance>& instances,
                              const PoseLimits& limits) {
  FalsePick pick;
  // The part it stands in is the one to compare with, however it is turned: that of a neighbour
  // may be nearer in angle.
  double error = 1e9;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (instances[i].truth.obj_id != obj_id) continue;
    const PoseError6 e = part.six_errors(estimate, instances[i].truth.T_cam_obj, limits);
    const double shift = Vec3(e[0], e[1], e[2]).norm();
    if (shift > kNearShare * part.diameter_mm()) continue;
    if (pick.instance >= 0 && shift >= pick.shift_mm) continue;
    error = relative_error(e, limits);
    pick.instance = static_cast<int>(i);
    pick.shift_mm = shift;
    pick.turn_deg = Vec3(e[3], e[4], e[5]).norm();
  }
  if (pick.instance < 0) return pick;
  const bool in_place = pick.shift_mm <= std::max(limits.mm, kInPlaceShare * part.diameter_mm());
  if (error < 1) {
    pick.kind = FalsePickKind::kRepeated;
  } else if (pick.turn_deg <= limits.deg) {
    pick.kind = FalsePickKind::kSlid;
  } else if (!in_place) {
    pick.kind = FalsePickKind::kAdrift;
  } else {
    pick.kind = pick.turn_deg > kFlippedDeg ? FalsePickKind::kFlipped : FalsePickKind::kTurned;
  }
  return pick;
}

std::string false_pick_text(const FalsePick& pick, const std::vector<ScoredInstance>& instances) {
  const std::string name = false_pick_name(pick.kind);
  if (pick.instance < 0) return name + ": no part is near";
  const ScoredInstance& i = instances[static_cast<std::size_t>(pick.instance)];
  return name + ": " + fixed_digits(pick.shift_mm, 1) + " mm and " +
         fixed_digits(pick.turn_deg, 0) + " deg from a part that is " +
         fixed_digits(100 * i.truth.visible_fraction, 0) + " % visible";
}

}  // namespace binpick::app
