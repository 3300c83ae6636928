#include "train/symmetry.hpp"

#include <algorithm>
#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "train/screw.hpp"
#include "train/self_match.hpp"

namespace binpick::train {
namespace {

// Of the depth error that verification reckons with, half is random: see Scene.
constexpr double kRandomErrorPx = 0.5, kWholeErrorPx = 1.1;
constexpr double kTwentyCorners = 0.0062;  // (1 - cos 9 deg) / 2
constexpr double kExactShareMax = 0.01;
constexpr double kSimilarShareMin = 0.012, kSimilarShareMax = 0.025;
// Less than this is no other pose: the search finds it from here.
constexpr double kSameTurn = 9 * kDegree;
constexpr double kSameShiftShare = 0.06;  // of the diameter
// A near symmetry less than this from a better one is on the slope towards it.
constexpr double kApartTurn = 30 * kDegree;
// About a near axis every angle is as good as another: what tells is small.
constexpr double kNearAxisDifferingMax = 0.35;
// A turn about it that differs by less than this share of what the others do stands for itself.
constexpr double kOwnTurnShare = 0.5;
// Angles that no symmetry of a few folds has in common.
constexpr double kOddAngles[] = {0.271, 0.743, 1.219, 1.697, 2.111, 2.633, 3.071};
constexpr std::size_t kLinesMax = 40;
// A near symmetry is where the part snaps in: turned on by this much, at least so much more of the
// surface differs. A plate turned by any angle in its plane still lies on itself for the most part.
constexpr double kSnapTurn = 10 * kDegree;
constexpr double kSnapShare = 0.04;

struct Move {
  Pose pose;
  double quick_differing = 1;
};

class Finder {
 public:
  Finder(const Mesh& mesh, double diameter_mm, const SymmetryTolerance& tolerance)
      : tolerance_(tolerance), matcher_(mesh, diameter_mm, tolerance.similar_mm) {}

  FoundSymmetry run() {
    for (const Pose& rough : matcher_.candidates()) {
      Move m{matcher_.refined(rough), 1};
      if (same_move(m.pose, Pose{})) continue;
      m.quick_differing = matcher_.quick_differing_share(m.pose);
      if (m.quick_differing < kNearDifferingMax + 0.1) moves_.push_back(m);
    }
    std::stable_sort(moves_.begin(), moves_.end(), [](const Move& a, const Move& b) {
      return a.quick_differing < b.quick_differing;
    });
    find_axes();
    find_exact_turns();
    close_group();
    tidy_group();
    find_near_turns();
    return result();
  }

 private:
  // Whether two moves lead to the same pose, as far as a search can tell.
  bool same_move(const Pose& a, const Pose& b, double turn_rad = kSameTurn) const {
    return rotation_angle_between(a.R, b.R) < turn_rad &&
           (turn_rad > kSameTurn || (a * matcher_.middle_mm() - b * matcher_.middle_mm()).norm() <
                                        kSameShiftShare * matcher_.diameter_mm());
  }

  // Whether they do when followed by some turn about the axis.
  bool same_about(const Screw& axis, const Pose& a, const Pose& b,
                  double turn_rad = kSameTurn) const {
    const Pose difference = a.inverse() * b;
    const double angle = angle_about(axis.axis, difference.R);
    return same_move(pose_of({axis.axis, axis.point_mm, angle, 0}), difference, turn_rad);
  }

  // Modulo the exact symmetries found so far.
  bool equivalent(const Pose& a, const Pose& b, double turn_rad = kSameTurn) const {
    if (exact_axes_.size() > 1) return true;
    const auto same = [&](const Pose& moved) {
      return exact_axes_.empty() ? same_move(moved, b, turn_rad)
                                 : same_about(exact_axes_.front(), moved, b, turn_rad);
    };
    if (same(a)) return true;
    return std::any_of(exact_.begin(), exact_.end(), [&](const Pose& g) { return same(a * g); });
  }

  std::vector<Screw> axis_candidates() const {
    std::vector<Screw> lines;
    const auto add = [&](const Screw& line) {
      for (const Screw& known : lines) {
        if (lines.size() == kLinesMax) return;
        const Vec3 apart = line.point_mm - known.point_mm;
        if (std::abs(known.axis.dot(line.axis)) > std::cos(5 * kDegree) &&
            (apart - apart.dot(known.axis) * known.axis).norm() < 0.03 * matcher_.diameter_mm())
          return;
      }
      lines.push_back(line);
    };
    for (const Move& m : moves_) add(screw_of(m.pose));
    for (const Vec3& axis : matcher_.special_axes()) add({axis, matcher_.middle_mm(), 0, 0});
    return lines;
  }

  // The same axis as two best fits about it see it: as exact as the CAD file.
  Screw precise(const Screw& line) const {
    Screw sum{Vec3::Zero(), Vec3::Zero(), 0, 0};
    for (const double angle : {1.219, 2.111}) {
      const Screw s = screw_of(matcher_.refined(pose_of({line.axis, line.point_mm, angle, 0})));
      sum.axis += s.axis.dot(line.axis) > 0 ? s.axis : Vec3(-s.axis);
      sum.point_mm += s.point_mm / 2;
    }
    sum.axis.normalize();
    return sum;
  }

  bool exact_about(const Screw& line) const {
    return std::all_of(std::begin(kOddAngles), std::end(kOddAngles), [&](double angle) {
      return matcher_.exact(pose_of({line.axis, line.point_mm, angle, 0}), tolerance_.exact_mm);
    });
  }

  double quick_worst_about(const Screw& line) const {
    double worst = 0;
    for (const double angle : kOddAngles) {
      worst =
          std::max(worst, matcher_.quick_differing_share(
                              pose_of({line.axis, line.point_mm, angle, 0}), kAlikeAboutAxisCos));
      if (worst > kNearDifferingMax + 0.1) break;
    }
    return worst;
  }

  // A near axis differs least along it: the others, tilted, are worse versions of the same.
  void find_axes() {
    struct Line {
      Screw line;
      double differing;
    };
    std::vector<Line> near;
    for (const Screw& rough : axis_candidates()) {
      const double worst = quick_worst_about(rough);
      if (worst > kNearDifferingMax + 0.1) continue;
      const Screw line = snapped(precise(rough), [&](const Screw& s) { return exact_about(s); });
      if (exact_about(line)) {
        add_exact_axis(line);
      } else {
        near.push_back(
            {snapped(rough, [&](const Screw& s) { return quick_worst_about(s) <= worst; }), worst});
      }
    }
    std::stable_sort(near.begin(), near.end(),
                     [](const Line& a, const Line& b) { return a.differing < b.differing; });
    for (const Line& n : near) {
      const bool known =
          !exact_axes_.empty() ||
          std::any_of(near_axes_.begin(), near_axes_.end(), [&](const SymmetryAxis& a) {
            return std::abs(axis_of(a).dot(n.line.axis)) > std::cos(30 * kDegree);
          });
      if (known || near_axes_.size() == 1) continue;
      SelfFit worst{0, 0};
      for (const double angle : kOddAngles) {
        const SelfFit f =
            matcher_.fit(pose_of({n.line.axis, n.line.point_mm, angle, 0}), kAlikeAboutAxisCos);
        worst.differing_share = std::max(worst.differing_share, f.differing_share);
        worst.deviation_mm = std::max(worst.deviation_mm, f.deviation_mm);
      }
      if (worst.differing_share <= kNearAxisDifferingMax)
        near_axes_.push_back(axis_row(SymmetryKind::kNear, n.line, worst));
    }
  }

  static Vec3 axis_of(const SymmetryAxis& a) {
    return Eigen::Map<const Eigen::Vector3f>(a.axis).cast<double>();
  }

  void add_exact_axis(const Screw& line) {
    for (const Screw& known : exact_axes_) {
      if (std::abs(known.axis.dot(line.axis)) > std::cos(20 * kDegree)) return;
    }
    exact_axes_.push_back(line);
  }

  void find_exact_turns() {
    for (const Move& m : moves_) {
      if (exact_.size() == kExactTurnsMax) return;
      if (m.quick_differing > 0.1 || equivalent(Pose{}, m.pose)) continue;
      if (matcher_.exact(m.pose, tolerance_.exact_mm)) exact_.push_back(m.pose);
    }
  }

  // Products of symmetries are symmetries: those that the search has missed.
  void close_group() {
    for (std::size_t i = 0; i < exact_.size(); ++i) {
      for (std::size_t k = 0; k < exact_.size(); ++k) {
        for (const Pose& product : {exact_[i] * exact_[k], exact_[k] * exact_[i]}) {
          if (exact_.size() == kExactTurnsMax) return;
          if (equivalent(Pose{}, product)) continue;
          const Pose move = matcher_.refined(product);
          if (!equivalent(Pose{}, move) && matcher_.exact(move, tolerance_.exact_mm))
            exact_.push_back(move);
        }
      }
    }
  }

  // Moves as the designer meant them: no shift, and where the part allows whole fractions of a turn
  // and axes of the CAD file. What fits only with a shift, like turns of a thread, leads beyond the
  // part's ends when repeated, and is no symmetry.
  void tidy_group() {
    const auto allowed = [&](const Screw& s) {
      return matcher_.exact(pose_of(s), tolerance_.exact_mm);
    };
    std::vector<Pose> tidied;
    for (const Pose& g : exact_) {
      Screw plain = screw_of(g);
      plain.shift_mm = 0;
      const Screw meant = snapped(with_whole_fraction(plain), allowed);
      if (allowed(meant)) {
        tidied.push_back(pose_of(meant));
      } else if (allowed(plain)) {
        tidied.push_back(pose_of(plain));
      }
    }
    exact_ = std::move(tidied);
  }

  static Screw with_whole_fraction(Screw s) {
    int fold = 1;
    for (int n = 2; n <= static_cast<int>(kExactTurnsMax) && fold == 1; ++n) {
      const double turns = s.angle_rad * n / (2 * kPi);
      if (std::abs(turns - std::round(turns)) * 2 * kPi / n < 0.5 * kDegree) fold = n;
    }
    if (fold > 1) {
      const double part = 2 * kPi / fold;
      s.angle_rad = part * std::round(s.angle_rad / part);
    }
    return s;
  }

  // With the axis turned onto one of the CAD file's where it is within half a degree and `allowed`.
  template <class Allowed>
  Screw snapped(const Screw& s, Allowed&& allowed) const {
    Screw out = s;
    for (int k = 0; k < 3; ++k) {
      if (std::abs(s.axis[k]) < std::cos(0.5 * kDegree)) continue;
      out.axis = s.axis[k] > 0 ? Vec3::Unit(k) : Vec3(-Vec3::Unit(k));
      out.point_mm -= out.point_mm.dot(out.axis) * out.axis;
    }
    for (int k = 0; k < 3; ++k) {
      if (std::abs(out.point_mm[k]) < 0.002 * matcher_.diameter_mm()) out.point_mm[k] = 0;
    }
    return allowed(out) ? out : s;
  }

  // Whether a near axis leads from a move to a turn that is no better than its neighbours.
  bool one_of_many(const Pose& from, const SymmetryTurn& turn) const {
    return std::any_of(near_axes_.begin(), near_axes_.end(), [&](const SymmetryAxis& a) {
      return turn.differing_share > static_cast<float>(kOwnTurnShare) * a.differing_share &&
             same_about(line_of(a), from, move_of(turn), kApartTurn);
    });
  }

  void find_near_turns() {
    std::vector<SymmetryTurn> found;
    for (const Move& m : moves_) {
      if (equivalent(Pose{}, m.pose, kApartTurn)) continue;
      const SelfFit fit = matcher_.fit(m.pose);
      if (fit.differing_share > kNearDifferingMax || !snaps_in(m.pose, fit)) continue;
      const SymmetryTurn turn = turn_row(SymmetryKind::kNear, screw_of(m.pose), fit);
      if (!one_of_many(Pose{}, turn)) found.push_back(turn);
    }
    std::stable_sort(found.begin(), found.end(), [](const SymmetryTurn& a, const SymmetryTurn& b) {
      return a.differing_share < b.differing_share;
    });
    for (const SymmetryTurn& t : found) {
      if (near_turns_.size() == kNearTurnsMax) break;
      const bool known =
          std::any_of(near_turns_.begin(), near_turns_.end(), [&](const SymmetryTurn& better) {
            return equivalent(move_of(better), move_of(t), kApartTurn) ||
                   one_of_many(move_of(better), t);
          });
      if (!known) near_turns_.push_back(t);
    }
  }

  bool snaps_in(const Pose& move, const SelfFit& fit) const {
    for (int k = 0; k < 6; ++k) {
      const Vec3 turn = (k % 2 == 0 ? kSnapTurn : -kSnapTurn) * Vec3(matcher_.frame().row(k / 2));
      const Pose turned = left_increment(move, turn, Vec3::Zero(), move * matcher_.middle_mm());
      if (matcher_.differing_share(turned) < fit.differing_share + kSnapShare) return false;
    }
    return true;
  }

  static Screw line_of(const SymmetryAxis& a) {
    return {axis_of(a), Eigen::Map<const Eigen::Vector3f>(a.point_mm).cast<double>(), 0, 0};
  }

  FoundSymmetry result() const {
    FoundSymmetry out;
    for (const Pose& g : exact_) {
      Screw turn = screw_of(g);
      turn.shift_mm = 0;  // but for rounding it is
      out.turns.push_back(turn_row(SymmetryKind::kExact, turn, SelfFit{0, 0}));
    }
    out.turns.insert(out.turns.end(), near_turns_.begin(), near_turns_.end());
    for (const Screw& line : exact_axes_)
      out.axes.push_back(axis_row(SymmetryKind::kExact, line, SelfFit{0, 0}));
    out.axes.insert(out.axes.end(), near_axes_.begin(), near_axes_.end());
    return out;
  }

  // Of the two ways to name an axis the one whose first component that is not 0 is positive.
  static double sign_of(const Vec3& axis) {
    for (int i = 0; i < 3; ++i) {
      if (std::abs(axis[i]) > 1e-3) return axis[i] > 0 ? 1 : -1;
    }
    return 1;
  }

  static SymmetryAxis axis_row(SymmetryKind kind, const Screw& screw, const SelfFit& fit) {
    SymmetryAxis row{};
    row.kind = kind;
    Screw s = screw;
    s.axis *= sign_of(s.axis);
    for (int i = 0; i < 3; ++i) {
      if (std::abs(s.axis[i]) < 1e-6) s.axis[i] = 0;  // no negative zero either
    }
    const Vec3 point = s.point_mm - s.point_mm.dot(s.axis) * s.axis;
    for (int i = 0; i < 3; ++i) {
      row.axis[i] = static_cast<float>(s.axis[i]);
      row.point_mm[i] = std::abs(point[i]) < 1e-6 ? 0 : static_cast<float>(point[i]);
    }
    row.differing_share = static_cast<float>(fit.differing_share);
    row.deviation_mm = static_cast<float>(fit.deviation_mm);
    return row;
  }

  static SymmetryTurn turn_row(SymmetryKind kind, const Screw& s, const SelfFit& fit) {
    const SymmetryAxis axis = axis_row(kind, s, fit);
    SymmetryTurn row{};
    row.kind = kind;
    std::copy_n(axis.axis, 3, row.axis);
    std::copy_n(axis.point_mm, 3, row.point_mm);
    const double sign = sign_of(s.axis);
    const bool half_turn = s.angle_rad > kPi - 5e-3;
    row.angle_rad = static_cast<float>(half_turn ? s.angle_rad : sign * s.angle_rad);
    row.shift_mm = static_cast<float>(sign * s.shift_mm);
    row.differing_share = axis.differing_share;
    row.deviation_mm = axis.deviation_mm;
    return row;
  }

  SymmetryTolerance tolerance_;
  SelfMatcher matcher_;
  std::vector<Move> moves_;  // least differing first
  std::vector<Screw> exact_axes_;
  std::vector<Pose> exact_;
  std::vector<SymmetryAxis> near_axes_;
  std::vector<SymmetryTurn> near_turns_;
};

}  // namespace

SymmetryTolerance symmetry_tolerance(double diameter_mm, double focal_px, double distance_mm) {
  const double pixel_mm = distance_mm / focal_px;
  SymmetryTolerance t;
  t.exact_mm = std::clamp(kRandomErrorPx * pixel_mm, kTwentyCorners * diameter_mm,
                          kExactShareMax * diameter_mm);
  t.similar_mm = std::clamp(kWholeErrorPx * pixel_mm, kSimilarShareMin * diameter_mm,
                            kSimilarShareMax * diameter_mm);
  return t;
}

FoundSymmetry find_symmetry(const Mesh& mesh, double diameter_mm,
                            const SymmetryTolerance& tolerance) {
  return Finder(mesh, diameter_mm, tolerance).run();
}

}  // namespace binpick::train
