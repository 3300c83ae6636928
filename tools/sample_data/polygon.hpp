// Triangulation of a plane region: what the flat faces of the sample parts are made of.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace binpick::simulation {

using Loop = std::vector<Eigen::Vector2d>;  // closed, first point not repeated

// A region with one outer loop and any number of holes; the loops must not touch each other.
struct Region {
  Loop outer;
  std::vector<Loop> holes;
};

// Triangles over the points of outer, holes[0], holes[1], ... counted through in this order.
// No points are added, so a wall set on the same loops closes the solid without a gap.
std::vector<std::array<int, 3>> triangulated(const Region& region);

Loop circle(const Eigen::Vector2d& centre, double radius, int points);
// A regular hexagon across flats with the same number of points on each side.
Loop hexagon(const Eigen::Vector2d& centre, double across_flats, int points);
// A slot along x: two half circles whose centres are length apart.
Loop slot(const Eigen::Vector2d& centre, double length, double radius, int points);

}  // namespace binpick::simulation
