#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "parts.hpp"
#include "solid_builder.hpp"

namespace binpick::simulation {
namespace {

constexpr double kThickness = 2;
constexpr double kInnerRadius = 2.5;
constexpr double kHalfWidth = 15;
constexpr double kLongFlange = 40;   // from the edge to where the bend begins
constexpr double kShortFlange = 20;  // from the end of the bend to the edge
constexpr double kBendLength = (kInnerRadius + kThickness / 2) * kPi / 2;
constexpr int kBendSteps = 20;
constexpr int kHolePoints = 120;

// Where a point of the flat pattern comes to lie: s runs along the pattern with 0 at the begin of
// the bend, depth from 0 (outside of the bend) to the thickness (inside).
Eigen::Vector3d bent(double across, double s, double depth) {
  const double radius = kInnerRadius + kThickness - depth;
  const double centre_z = kInnerRadius + kThickness;
  if (s <= 0) return {s, across, depth};
  const double angle = std::min(s / kBendLength, 1.0) * kPi / 2;
  Eigen::Vector3d p(radius * std::sin(angle), across, centre_z - radius * std::cos(angle));
  if (s > kBendLength) p.z() += s - kBendLength;
  return p;
}

void add_arc(Loop& loop, const Eigen::Vector2d& centre, double radius, double begin) {
  constexpr int kSteps = 20;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = begin + kPi / 2 * i / kSteps;
    loop.emplace_back(centre.x() + radius * std::cos(angle), centre.y() + radius * std::sin(angle));
  }
}

// Pattern coordinates are (s, across).
Region long_flange() {
  Region region;
  region.outer = {{0, -kHalfWidth}, {0, kHalfWidth}};
  add_arc(region.outer, {-kLongFlange + 5, kHalfWidth - 5}, 5, kPi / 2);
  region.outer.emplace_back(-kLongFlange,
                            -kHalfWidth + 10);  // the cut corner tells left from right
  region.outer.emplace_back(-kLongFlange + 10, -kHalfWidth);
  region.holes.push_back(circle({-30, 6}, 4.2, kHolePoints));
  region.holes.push_back(slot({-13, -3}, 11, 3, kHolePoints));
  return region;
}

Region short_flange() {
  const double end = kBendLength + kShortFlange;
  Region region;
  region.outer = {{kBendLength, kHalfWidth}, {kBendLength, -kHalfWidth}};
  add_arc(region.outer, {end - 8, -kHalfWidth + 8}, 8, -kPi / 2);
  add_arc(region.outer, {end - 3, kHalfWidth - 3}, 3, 0);
  region.holes.push_back(circle({kBendLength + 10, -5}, 3.2, kHolePoints));
  return region;
}

void add_sheet(SolidBuilder& solid, const Region& region) {
  for (double depth : {0.0, kThickness}) {
    solid.add_face(region, [depth](Eigen::Vector2d p) { return bent(p.y(), p.x(), depth); });
  }
  const auto ring = [](const Loop& loop, double depth) {
    Ring out;
    for (const auto& p : loop) out.push_back(bent(p.y(), p.x(), depth));
    return out;
  };
  for (const auto& hole : region.holes) solid.add_wall(ring(hole, 0), ring(hole, kThickness));
  // The first edge of the outline lies at the bend and stays open.
  Ring top = ring(region.outer, 0);
  Ring bottom = ring(region.outer, kThickness);
  top.push_back(top.front());
  bottom.push_back(bottom.front());
  top.erase(top.begin());
  bottom.erase(bottom.begin());
  solid.add_grid({top, bottom});
}

}  // namespace

TriangleMesh make_clip() {
  SolidBuilder solid;
  add_sheet(solid, long_flange());
  add_sheet(solid, short_flange());
  for (int i = 0; i < kBendSteps; ++i) {
    const double a = kBendLength * i / kBendSteps;
    const double b = kBendLength * (i + 1) / kBendSteps;
    const auto section = [](double s) {
      return Ring{bent(-kHalfWidth, s, 0), bent(kHalfWidth, s, 0), bent(kHalfWidth, s, kThickness),
                  bent(-kHalfWidth, s, kThickness)};
    };
    solid.add_wall(section(a), section(b));
  }
  return solid.finish();
}

}  // namespace binpick::simulation
