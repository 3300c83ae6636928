#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "parts.hpp"
#include "solid_builder.hpp"

namespace binpick::simulation {
namespace {

constexpr int kPoints = 96;

// The outline of the flange: a disc and a small disc to the side, held by their common tangents.
Loop lug_outline(double radius, double lug_at, double lug_radius) {
  const double touch = std::acos((radius - lug_radius) / lug_at);
  Loop loop;
  for (int i = 0; i <= kPoints; ++i) {
    const double angle = touch + (2 * kPi - 2 * touch) * i / kPoints;
    loop.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  for (int i = 0; i <= kPoints / 3; ++i) {
    const double angle = -touch + 2 * touch * i / (kPoints / 3);
    loop.emplace_back(lug_at + lug_radius * std::cos(angle), lug_radius * std::sin(angle));
  }
  return loop;
}

}  // namespace

TriangleMesh make_hub() {
  SolidBuilder solid;
  const auto round = [](double radius) { return circle({0, 0}, radius, kPoints); };
  const auto wall = [&solid](const Loop& a, double za, const Loop& b, double zb) {
    solid.add_wall(at_height(a, za), at_height(b, zb));
  };
  // The shaft below the flange, from its end upwards, with a groove for a retaining ring.
  solid.add_face({round(6), {}}, -30);
  wall(round(6), -30, round(7), -29);
  wall(round(7), -29, round(7), -25);
  wall(round(7), -25, round(6), -25);
  wall(round(6), -25, round(6), -23);
  wall(round(6), -23, round(7), -23);
  wall(round(7), -23, round(7), -12);
  wall(round(7), -12, round(9), -12);
  wall(round(9), -12, round(9), 0);
  // The flange with its lug.
  const Loop outline = lug_outline(15, 24, 6);
  const Loop lug_hole = circle({24, 0}, 3.2, kPoints / 2);
  solid.add_face({outline, {round(9), lug_hole}}, 0);
  wall(outline, 0, outline, 5);
  wall(lug_hole, 0, lug_hole, 5);
  solid.add_face({outline, {round(11), lug_hole}}, 5);
  // The hub on top with the socket.
  const Loop socket = hexagon({0, 0}, 12, kPoints);
  wall(round(11), 5, round(11), 13);
  wall(round(11), 13, round(10), 14);
  wall(round(10), 14, socket, 14);
  wall(socket, 14, socket, 4);
  solid.add_face({socket, {}}, 4);
  return solid.finish();
}

}  // namespace binpick::simulation
