#include <cmath>

#include "binpick/geometry/angle.hpp"
#include "parts.hpp"
#include "solid_builder.hpp"

namespace binpick::simulation {
namespace {

constexpr int kSides = 48;           // points round the branch; divisible by 8
constexpr int kBackColumns = 26;     // columns of the run's back, away from the branch
constexpr int kBlendRings = 4;       // rings between branch and run
constexpr double kPatchAngle = 1.3;  // half the patch of the run that holds the branch, rad
constexpr double kPatchLength = 12;  // the same along the run, mm

struct Station {
  double at, radius;
};

// A cylinder along x with an opening towards +z where the branch leaves it. The surface is laid out
// as a rectangle (x, angle): rings blend the opening's outline into the rectangle's border, and
// a regular grid closes the back.
class RunSurface {
 public:
  RunSurface(double run_radius, double branch_radius) : run_radius_(run_radius) {
    for (int k = 0; k < kSides; ++k) {
      const double phi = 2 * kPi * k / kSides;
      const Eigen::Vector2d hole(branch_radius * std::cos(phi),
                                 std::asin(branch_radius * std::sin(phi) / run_radius));
      const double stretch = 1 / std::max(std::abs(std::cos(phi)), std::abs(std::sin(phi)));
      const Eigen::Vector2d border(kPatchLength * stretch * std::cos(phi),
                                   kPatchAngle * stretch * std::sin(phi));
      hole_.push_back(hole);
      border_.push_back(border);
    }
  }

  void add_to(SolidBuilder& solid) const {
    for (int r = 0; r < kBlendRings; ++r) solid.add_wall(blended(r), blended(r + 1));
    std::vector<Ring> rows;
    for (int c = 0; c <= kBackColumns; ++c) {
      const double angle = kPatchAngle + (2 * kPi - 2 * kPatchAngle) * c / kBackColumns;
      Ring row;
      for (double x : side_positions(kPatchLength)) row.push_back(lifted({x, angle}));
      rows.push_back(row);
    }
    solid.add_grid(rows);
  }

  // The border at one end of the patch, as a ring of any radius at any x.
  Ring end_ring(double x, double radius) const {
    std::vector<double> angles = side_positions(kPatchAngle);
    for (int c = 1; c < kBackColumns; ++c) {
      angles.push_back(kPatchAngle + (2 * kPi - 2 * kPatchAngle) * c / kBackColumns);
    }
    Ring ring;
    for (double a : angles) ring.emplace_back(x, radius * std::sin(a), radius * std::cos(a));
    return ring;
  }

  Ring opening() const { return blended(0); }

 private:
  Eigen::Vector3d lifted(const Eigen::Vector2d& p) const {
    return {p.x(), run_radius_ * std::sin(p.y()), run_radius_ * std::cos(p.y())};
  }

  Ring blended(int ring) const {
    const double share = static_cast<double>(ring) / kBlendRings;
    Ring out;
    for (int k = 0; k < kSides; ++k) {
      out.push_back(lifted((1 - share) * hole_[k] + share * border_[k]));
    }
    return out;
  }

  // Where the border's points lie along one side of it.
  static std::vector<double> side_positions(double half) {
    std::vector<double> at;
    for (int j = -kSides / 8; j <= kSides / 8; ++j)
      at.push_back(half * std::tan(2 * kPi * j / kSides));
    return at;
  }

  double run_radius_;
  Loop hole_, border_;
};

}  // namespace

TriangleMesh make_tee() {
  constexpr double kRunOuter = 10;
  constexpr double kRunInner = 7.4;
  constexpr double kBranchOuter = 7.4;
  constexpr double kBranchInner = 5.2;
  const RunSurface outer(kRunOuter, kBranchOuter);
  const RunSurface inner(kRunInner, kBranchInner);
  SolidBuilder solid;
  outer.add_to(solid);
  inner.add_to(solid);

  // From the outer patch over the collar and back through the socket to the inner patch.
  const std::vector<Station> run = {{kPatchLength, kRunOuter},
                                    {15, kRunOuter},
                                    {16, 12.6},
                                    {27.2, 12.6},
                                    {28, 11.8},
                                    {28, 10.1},
                                    {27.3, 9.4},
                                    {18, 9.4},
                                    {18, kRunInner},
                                    {kPatchLength, kRunInner}};
  for (double side : {-1.0, 1.0}) {
    for (std::size_t i = 0; i + 1 < run.size(); ++i) {
      solid.add_wall(outer.end_ring(side * run[i].at, run[i].radius),
                     outer.end_ring(side * run[i + 1].at, run[i + 1].radius));
    }
  }

  // The same on the branch, whose collar is a hexagon.
  std::vector<Ring> branch = {outer.opening()};
  const auto round = [](double radius, double z) {
    return at_height(circle({0, 0}, radius, kSides), z);
  };
  const auto hex = [](double flats, double z) {
    return at_height(hexagon({0, 0}, flats, kSides), z);
  };
  branch.push_back(round(kBranchOuter, 17));
  branch.push_back(hex(20, 17));
  branch.push_back(hex(20, 27));
  branch.push_back(round(8.6, 27));
  branch.push_back(round(8.6, 32));
  branch.push_back(round(7.0, 32));
  branch.push_back(round(7.0, 20));
  branch.push_back(round(kBranchInner, 20));
  branch.push_back(inner.opening());
  for (std::size_t i = 0; i + 1 < branch.size(); ++i) solid.add_wall(branch[i], branch[i + 1]);
  return solid.finish();
}

}  // namespace binpick::simulation
