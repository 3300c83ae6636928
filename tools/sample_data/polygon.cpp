#include "polygon.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "binpick/geometry/angle.hpp"

namespace binpick::simulation {
namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

double area(const std::vector<Vector2d>& points, const std::vector<int>& chain) {
  double sum = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Vector2d& a = points[chain[i]];
    const Vector2d& b = points[chain[(i + 1) % chain.size()]];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum / 2;
}

bool crosses(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  return cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0;
}

// Joins a hole to the chain by the shortest pair of points that crosses no other edge.
void bridge(const std::vector<Vector2d>& points, std::vector<int>& chain,
            const std::vector<int>& hole, const std::vector<std::vector<int>>& others) {
  const auto blocked = [&](int a, int b) {
    const auto hits = [&](const std::vector<int>& loop) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        if (crosses(points[a], points[b], points[loop[i]], points[loop[(i + 1) % loop.size()]])) {
          return true;
        }
      }
      return false;
    };
    return hits(chain) || hits(hole) || std::any_of(others.begin(), others.end(), hits);
  };
  double length_best = 1e300;
  std::size_t at_best = 0;
  std::size_t hole_best = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    for (std::size_t j = 0; j < hole.size(); ++j) {
      const double length = (points[chain[i]] - points[hole[j]]).squaredNorm();
      if (length < length_best && !blocked(chain[i], hole[j])) {
        length_best = length;
        at_best = i;
        hole_best = j;
      }
    }
  }
  std::vector<int> joined(chain.begin(), chain.begin() + static_cast<long>(at_best) + 1);
  for (std::size_t j = 0; j <= hole.size(); ++j) {
    joined.push_back(hole[(hole_best + j) % hole.size()]);
  }
  joined.insert(joined.end(), chain.begin() + static_cast<long>(at_best), chain.end());
  chain = std::move(joined);
}

// Twice the area over the longest side squared: large for well-shaped ears, 0 for no ear.
double ear_quality(const std::vector<Vector2d>& points, const std::vector<int>& chain,
                   std::size_t at) {
  const std::size_t n = chain.size();
  const int ia = chain[(at + n - 1) % n];
  const int ib = chain[at];
  const int ic = chain[(at + 1) % n];
  const Vector2d& a = points[ia];
  const Vector2d& b = points[ib];
  const Vector2d& c = points[ic];
  const double twice = cross(a, b, c);
  if (twice <= 1e-12) return 0;
  for (int i : chain) {
    const Vector2d& p = points[i];
    if (i == ia || i == ib || i == ic) continue;
    if (cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0) return 0;
  }
  const double longest =
      std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()});
  return twice / longest;
}

}  // namespace

std::vector<std::array<int, 3>> triangulated(const Region& region) {
  std::vector<Vector2d> points;
  const auto append = [&](const Loop& loop, bool counter_clockwise) {
    std::vector<int> chain;
    for (const auto& p : loop) {
      chain.push_back(static_cast<int>(points.size()));
      points.push_back(p);
    }
    if ((area(points, chain) > 0) != counter_clockwise) std::reverse(chain.begin(), chain.end());
    return chain;
  };
  std::vector<int> chain = append(region.outer, true);
  std::vector<std::vector<int>> holes;
  for (const auto& hole : region.holes) holes.push_back(append(hole, false));
  while (!holes.empty()) {
    const std::vector<int> hole = holes.back();
    holes.pop_back();
    bridge(points, chain, hole, holes);
  }
  std::vector<std::array<int, 3>> triangles;
  while (chain.size() > 2) {
    std::size_t best = 0;
    double quality_best = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const double quality = ear_quality(points, chain, i);
      if (quality > quality_best) {
        quality_best = quality;
        best = i;
      }
    }
    if (quality_best <= 0) throw std::logic_error("a face of a sample part has crossing loops");
    const std::size_t n = chain.size();
    triangles.push_back({chain[(best + n - 1) % n], chain[best], chain[(best + 1) % n]});
    chain.erase(chain.begin() + static_cast<long>(best));
  }
  return triangles;
}

Loop circle(const Vector2d& centre, double radius, int points) {
  Loop loop;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * kPi * i / points;
    loop.push_back(centre + radius * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return loop;
}

Loop hexagon(const Vector2d& centre, double across_flats, int points) {
  Loop loop;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * kPi * i / points;
    const double to_flat = std::remainder(angle - kPi / 6, kPi / 3);
    const double radius = across_flats / 2 / std::cos(to_flat);
    loop.push_back(centre + radius * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return loop;
}

Loop slot(const Vector2d& centre, double length, double radius, int points) {
  Loop loop;
  for (int i = 0; i <= points / 2; ++i) {
    const double angle = -kPi / 2 + 2 * kPi * i / points;
    loop.push_back(centre +
                   Vector2d(length / 2 + radius * std::cos(angle), radius * std::sin(angle)));
  }
  const std::size_t half = loop.size();
  for (std::size_t i = 0; i < half; ++i) loop.push_back(2 * centre - loop[i]);
  return loop;
}

}  // namespace binpick::simulation
