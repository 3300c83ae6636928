#include <algorithm>
#include <cmath>

#include "parts.hpp"
#include "solid_builder.hpp"

namespace binpick::simulation {
namespace {

// An M10 x 40 bolt with 26 mm of thread.
constexpr double kRadius = 5;
constexpr double kPitch = 1.5;
constexpr double kThreadDepth = 0.92;
constexpr double kTipRadius = 3.8;
constexpr double kThreadEnd = 26;
constexpr double kShankEnd = 40;
constexpr double kHeadEnd = 46.4;
constexpr double kAcrossFlats = 17;

constexpr int kAround = 48;
// From a crest to the next: a row at the crest, two on either flank, three along the root.
constexpr std::array kDepths = {0.0, 0.2, 0.6, 1.0, 1.0, 1.0, 0.6, 0.2};
constexpr int kRowsPerPitch = static_cast<int>(kDepths.size());

// Rows climb one pitch a turn, so that each stays at its place of the thread's profile; a row's end
// is the start of the row one pitch further up. Beyond the thread's ends, rows are pressed flat.
std::vector<Ring> thread_rows() {
  constexpr double kRise = kPitch / (kRowsPerPitch * kAround);  // from a point to the next, if the
                                                                // rows were one
  const Loop unit = circle({0, 0}, 1, kAround);
  const int rows = static_cast<int>(std::ceil((kThreadEnd / kPitch + 1) * kRowsPerPitch)) + 1;
  std::vector<Ring> out;
  for (int row = 0; row < rows; ++row) {
    Ring ring;
    for (int i = 0; i <= kAround; ++i) {
      const double at = (row * kAround + i * kRowsPerPitch) * kRise - kPitch;
      const double z = std::clamp(at, 0.0, kThreadEnd);
      const double runout = std::min(1.0, (kThreadEnd - z) / kPitch);
      const double depth =
          kThreadDepth * runout * kDepths[static_cast<std::size_t>(row % kRowsPerPitch)];
      const double radius = std::min(kRadius - depth, kTipRadius + z);
      const Eigen::Vector2d& p = unit[static_cast<std::size_t>(i % kAround)];
      ring.emplace_back(radius * p.x(), radius * p.y(), z);
    }
    out.push_back(std::move(ring));
  }
  return out;
}

}  // namespace

TriangleMesh make_bolt() {
  SolidBuilder solid;
  const auto round = [](double radius) { return circle({0, 0}, radius, kAround); };
  const auto wall = [&solid](const Loop& a, double za, const Loop& b, double zb) {
    solid.add_wall(at_height(a, za), at_height(b, zb));
  };
  solid.add_face({round(kTipRadius), {}}, 0);
  solid.add_grid(thread_rows());
  wall(round(kRadius), kThreadEnd, round(kRadius), kShankEnd);
  const Loop head = hexagon({0, 0}, kAcrossFlats, kAround);
  const Loop top = round(0.47 * kAcrossFlats);
  solid.add_face({head, {round(kRadius)}}, kShankEnd);
  wall(head, kShankEnd, head, kHeadEnd - 0.8);
  wall(head, kHeadEnd - 0.8, top, kHeadEnd);
  solid.add_face({top, {}}, kHeadEnd);
  return solid.finish();
}

}  // namespace binpick::simulation
