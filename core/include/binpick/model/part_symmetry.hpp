// How a part looks like itself after a move: found from the CAD at training, stored in the model
// file as it stands here. A move is a screw: a turn about an axis through a point, and a shift
// along it. Lengths in mm, in the coordinates of the middle of the part's bounding box.
#pragma once

#include <cstdint>
#include <span>

#include "binpick/geometry/pose.hpp"

namespace binpick {

// Exact: no point of the visible surface moves off it by more than the CAD file and a sensor are
// precise to. Near: most of the visible surface coincides, but something tells. Indistinguishable:
// near, and in the simulated piles of the training detection takes the one for the other.
enum class SymmetryKind : std::int32_t { kExact = 0, kNear = 1, kIndistinguishable = 2 };

struct SymmetryTurn {
  SymmetryKind kind;
  float axis[3];  // unit
  float point_mm[3];
  float angle_rad;        // in (-pi, pi], not 0
  float shift_mm;         // along the axis; 0 for an exact one
  float differing_share;  // of the visible surface, 0..1; 0 for an exact one
  float deviation_mm;     // of what differs, at most
};

// Any angle about this axis.
struct SymmetryAxis {
  SymmetryKind kind;
  float axis[3];
  float point_mm[3];
  float differing_share;  // at the angle that differs most
  float deviation_mm;
};

inline constexpr std::size_t kExactTurnsMax = 120;  // the icosahedron has 59
inline constexpr std::size_t kNearTurnsMax = 8;
inline constexpr std::size_t kSymmetryAxesMax = 4;

// The exact symmetries are the identity and the exact turns, each of them followed by any turn
// about an exact axis; three exact axes mean a ball.
// Of the near ones any may be indistinguishable.
struct PartSymmetry {
  std::span<const SymmetryTurn> exact_turns, near_turns;
  std::span<const SymmetryAxis> exact_axes, near_axes;
};

// Whether poses that differ by a near symmetry are one to whoever asks for them.
enum class NearSymmetry : std::int32_t {
  kAuto = 0,    // where it is indistinguishable
  kEquivalent,  // always: the gripper does not care how the part is turned
  kDistinct,    // never: what cannot be told apart gets a low score
};
inline constexpr const char* kNearSymmetryNames[] = {"auto", "equivalent", "distinct"};

// An axis or a point of the above.
Vec3 vector_of(const float (&v)[3]);

// x -> move * x brings the part onto itself: T_cam_centre * move looks like T_cam_centre.
Pose move_of(const SymmetryTurn& turn);
Pose move_about(const SymmetryAxis& axis, double angle_rad);
// The same move in the CAD's coordinates, where the middle of the bounding box lies at centre_mm.
Pose in_cad(const Pose& move, const Vec3& centre_mm);

}  // namespace binpick
