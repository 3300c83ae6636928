// What the scalar pose kernels, which are the specification, compute: against geometry that is
// known.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "pose_inputs.hpp"
#include "simd/pose_kernels.hpp"

namespace binpick::simd {
namespace {

using Vec6d = Eigen::Matrix<double, 6, 1>;

const PoseKernels kKernels = pose_kernels_scalar();
const Vec3 kTowardsCamera = -Vec3::UnitZ();
constexpr double kPlane_mm = 200;
constexpr SurfaceTolerance kTolerance{1, 4, 0.6f, 0.75f, 0.2f};

PoseF shifted(const Vec3& t) {
  return pose_of(Mat3::Identity(), t);
}

// A square of the plane before the camera, facing it.
PoseSamples square() {
  PoseSamples out(100);
  for (int i = 0; i < 100; ++i)
    out.set(i, Vec3(8.0 * (i % 10) - 36, 6.0 * (i / 10) - 27, 0), kTowardsCamera);
  return out;
}

DepthImage plane() {
  return DepthImage([](int, int) { return kPlane_mm; });
}

TEST(SurfaceKernels, ResidualIsTheOffsetAlongTheNormal) {
  const PoseSamples samples = square();
  const DepthImage depth = plane();
  const auto look = std::make_unique<SurfaceLook>();
  for (const double off_mm : {-0.4, 0.0, 0.3}) {
    const PoseF T = shifted({1, -2, kPlane_mm + off_mm});
    kKernels.look_at_surface(samples.arrays(), T, depth.map(), *look);
    EquationSums sums{};
    constexpr float kGate_mm = 10;
    kKernels.surface_equations(samples.arrays(), T, depth.map(), kGate_mm, sums);
    for (int i = 0; i < 100; ++i) {
      ASSERT_NEAR(-off_mm, look->offset_mm[i], 1e-4);
      ASSERT_NEAR(off_mm, look->residual_mm[i], 1e-4) << "of the measured point from the model";
    }
    const double k = 1 + off_mm * off_mm * 4 / 100, weight = 1 / (k * k);
    EXPECT_EQ(100, sums.count);
    EXPECT_NEAR(100 * weight * off_mm * off_mm, sums.cost, 1e-2);
    EXPECT_NEAR(100 * weight, sums.H[20], 1e-2);
    EXPECT_NEAR(100 * weight * off_mm, sums.g[5], 1e-2) << "downhill is back to the plane";
  }
}

TEST(SurfaceKernels, OnlyWhatFacesTheCameraWithinTheGateIsAligned) {
  const DepthImage depth = plane();
  PoseSamples away = square();
  away.set(7, Vec3::Zero(), -kTowardsCamera);
  EquationSums sums{};
  kKernels.surface_equations(away.arrays(), shifted({0, 0, kPlane_mm}), depth.map(), 10, sums);
  EXPECT_EQ(99, sums.count);
  sums = {};
  kKernels.surface_equations(away.arrays(), shifted({0, 0, kPlane_mm + 10.5}), depth.map(), 10,
                             sums);
  EXPECT_EQ(0, sums.count);
  EXPECT_EQ(0, sums.cost);
}

TEST(SurfaceKernels, OneSampleGivesTheProductsOfItsDerivatives) {
  PoseSamples one(1);
  const Vec3 p(7, -3, 5), n = Vec3(0.2, 0.3, -1).normalized();
  one.set(0, p, n);
  const DepthImage depth([&](int, int) { return kPlane_mm + 5; });
  EquationSums sums{};
  kKernels.surface_equations(one.arrays(), shifted({0, 0, kPlane_mm}), depth.map(), 1e6f, sums);
  ASSERT_EQ(1, sums.count);
  Vec6d J;
  J << p.cross(n), n;
  int k = 0;
  for (int column = 0; column < 6; ++column) {
    for (int row = column; row < 6; ++row, ++k)
      EXPECT_NEAR(J[row] * J[column], sums.H[k], 1e-4) << row << ' ' << column;
  }
}

// Two planes that meet in a ridge, each point of them on the ray of a pixel.
struct Roof {
  static Vec3 normal(int u) {
    return (u < DepthImage::kWidth / 2 ? Vec3(-0.4, 0.1, -1) : Vec3(0.3, 0.25, -1)).normalized();
  }
  static double depth_mm(int u, int v) {
    return kPlane_mm * normal(u).z() / normal(u).dot(DepthImage::ray(u, v));
  }

  Roof() : image(depth_mm), samples(kCount) {
    for (int i = 0; i < kCount; ++i) {
      const int column = i % 20, u = (column < 10 ? 5 : 26) + 2 * column + column / 10;
      const int v = 8 + 2 * (i / 20);
      samples.set(i, depth_mm(u, v) * DepthImage::ray(u, v) - middle, normal(u));
    }
  }
  PoseF moved(const Vec6d& by) const {
    const Pose T = left_increment({Mat3::Identity(), middle}, by.head<3>(), by.tail<3>(), middle);
    return pose_of(T.R, T.t_mm);
  }
  // What the weights of the equations belong to: sum of r^2 / (1 + 4 r^2 / gate^2).
  double robust_cost(const Vec6d& by) const {
    const auto look = std::make_unique<SurfaceLook>();
    kKernels.look_at_surface(samples.arrays(), moved(by), image.map(), *look);
    double sum = 0;
    for (int i = 0; i < kCount; ++i) {
      const double r = static_cast<double>(look->residual_mm[i]);
      sum += r * r / (1 + 4 * r * r / (kGate_mm * kGate_mm));
    }
    return sum;
  }

  static constexpr int kCount = 320;
  static constexpr double kGate_mm = 2;
  const Vec3 middle{0, 0, kPlane_mm};
  DepthImage image;
  PoseSamples samples;
};

TEST(SurfaceKernels, GradientIsThatOfTheRobustCost) {
  const Roof roof;
  // Samples stay on the rays of their pixels, nearly: what a turn of their normals makes of a
  // distance across is none of the equations'.
  Vec6d off;
  off << 0.0008, -0.0006, 0.001, 0.04, -0.06, 0.3;
  EquationSums sums{};
  kKernels.surface_equations(roof.samples.arrays(), roof.moved(off), roof.image.map(),
                             static_cast<float>(Roof::kGate_mm), sums);
  ASSERT_EQ(Roof::kCount, sums.count);
  Vec6d found, numerical;
  for (int k = 0; k < 6; ++k) {
    // About the part's centre where it is now, as the increment of an alignment is.
    const double step = k < 3 ? 5e-4 : 2e-2;
    Vec6d up = off, down = off;
    up[k] += step;
    down[k] -= step;
    found[k] = static_cast<double>(sums.g[k]);
    numerical[k] = (roof.robust_cost(up) - roof.robust_cost(down)) / (4 * step);
  }
  EXPECT_LT((found - numerical).head<3>().norm(), 0.05 * numerical.head<3>().norm())
      << found.transpose() << "\n"
      << numerical.transpose();
  EXPECT_LT((found - numerical).tail<3>().norm(), 0.05 * numerical.tail<3>().norm())
      << found.transpose() << "\n"
      << numerical.transpose();
}

SurfaceAgreement agreement(const DepthImage& depth, double off_mm) {
  const float from[3] = {0, 0, -1};
  SurfaceAgreement out{};
  kKernels.surface_agreement(square().arrays(), shifted({0, 0, kPlane_mm + off_mm}), depth.map(),
                             kTolerance, from, out);
  return out;
}

TEST(SurfaceKernels, AgreementFollowsTheResidual) {
  const DepthImage depth = plane();
  const SurfaceAgreement exact = agreement(depth, 0);
  EXPECT_EQ(100, exact.agreeing);
  EXPECT_NEAR(100, exact.supported, 1e-3);
  EXPECT_NEAR(100, exact.explained, 5) << "seen as in its viewpoint, but for the perspective";
  for (const double off_mm : {-2.0, 1.0, 3.0})
    EXPECT_NEAR(100 * std::exp(-off_mm * off_mm / 2), agreement(depth, off_mm).supported, 4);
  EXPECT_EQ(100, agreement(depth, 4.5).hidden);
  EXPECT_EQ(100, agreement(depth, -4.5).contradicted);
  EXPECT_EQ(0, agreement(depth, 4.5).agreeing);
}

TEST(SurfaceKernels, AgreementFallsWithTheAngleBetweenNormals) {
  DepthImage depth = plane();
  const auto support = [&](double angle_deg) {
    const double x = std::sin(angle_deg * kDegree);
    // One sample in the middle: its ray is the axis.
    PoseSamples one(1);
    one.set(0, Vec3::Zero(), kTowardsCamera);
    depth.set_normals(x, 0);
    const float from[3] = {0, 0, -1};
    SurfaceAgreement out{};
    kKernels.surface_agreement(one.arrays(), shifted({0, 0, kPlane_mm}), depth.map(), kTolerance,
                               from, out);
    return static_cast<double>(out.supported);
  };
  EXPECT_NEAR(1, support(0), 1e-6);
  EXPECT_NEAR(1, support(40), 1e-6);
  EXPECT_NEAR((std::cos(45 * kDegree) - 0.6) / 0.15, support(45), 1e-4);
  EXPECT_NEAR(0.2, support(52), 1e-6);
  EXPECT_NEAR(0.2, support(80), 1e-6);
}

// The normal of a level plane, in the frame of each pixel's ray, agrees with it all over the image.
TEST(SurfaceKernels, NormalsStandInTheFramesOfTheirRays) {
  for (const int u : {2, 20, 60, 77}) {
    for (const int v : {3, 28, 50}) {
      const Vec3 ray = DepthImage::ray(u, v).normalized();
      const Vec3 n = Eigen::Quaterniond::FromTwoVectors(ray, Vec3::UnitZ()) * kTowardsCamera;
      DepthImage depth = plane();
      depth.set_normals(n.x(), n.y());
      PoseSamples one(1);
      // Turned by 48 degrees: as good a measure of the angle as there is.
      const Vec3 across = ray.cross(kTowardsCamera).normalized();
      const Vec3 turned = rotation_from_vector(48 * kDegree * across) * kTowardsCamera;
      one.set(0, Vec3::Zero(), turned);
      const float from[3] = {0, 0, -1};
      SurfaceAgreement out{};
      const Vec3 at = kPlane_mm * DepthImage::ray(u, v);
      kKernels.surface_agreement(one.arrays(), shifted(at), depth.map(), kTolerance, from, out);
      EXPECT_NEAR((std::cos(48 * kDegree) - 0.6) / 0.15, out.supported, 1e-3) << u << ' ' << v;
    }
  }
}

TEST(ContourKernels, PlacesAreProjections) {
  const GrayImage gray([](int, int) { return 90.0; });
  const DepthImage nothing;
  PoseSamples one(1);
  const Vec3 p(10, -15, 20), d = Vec3(1, 2, 0.5).normalized();
  one.set(0, p, d);
  const auto places = std::make_unique<ContourPlaces>();
  kKernels.place_contour(one.arrays(), shifted({0, 0, 180}), gray.map(), nothing.map(), 6, 1,
                         *places);
  const auto project = [](const Vec3& q) {
    return Vec2(79.5 + 200 * q.x() / q.z(), 55.5 + 200 * q.y() / q.z());
  };
  const Vec3 q = p + Vec3(0, 0, 180);
  EXPECT_NEAR(project(q).x(), places->u[0], 1e-4);
  EXPECT_NEAR(project(q).y(), places->v[0], 1e-4);
  EXPECT_EQ(-1, places->visible[0]);
  const Vec2 along = (project(q + 0.01 * d) - project(q - 0.01 * d)).normalized();
  const Vec2 normal(static_cast<double>(places->normal_u[0]),
                    static_cast<double>(places->normal_v[0]));
  EXPECT_NEAR(1, normal.norm(), 1e-6);
  EXPECT_NEAR(0, normal.dot(along), 1e-4);
}

TEST(ContourKernels, WhatIsNearerHidesAPlaceAndTheBorderIsLeftOut) {
  const GrayImage gray([](int, int) { return 90.0; });
  PoseSamples one(1);
  one.set(0, Vec3::Zero(), Vec3::UnitX());
  const auto visible = [&](const Vec3& at, double measured_mm) {
    const DepthImage depth([&](int, int) { return measured_mm; });
    const auto places = std::make_unique<ContourPlaces>();
    kKernels.place_contour(one.arrays(), shifted(at), gray.map(), depth.map(), 6, 3, *places);
    return places->visible[0] != 0;
  };
  EXPECT_TRUE(visible({0, 0, 200}, 0)) << "nothing measured";
  EXPECT_TRUE(visible({0, 0, 200}, 197.5));
  EXPECT_FALSE(visible({0, 0, 200}, 196.5));
  EXPECT_TRUE(visible({0, 0, 200}, 300));
  EXPECT_TRUE(visible({6.6 - 79.5, 0, 200}, 0));
  EXPECT_FALSE(visible({5.4 - 79.5, 0, 200}, 0)) << "within the margin";
  EXPECT_FALSE(visible({0, 0, -200}, 0) && visible({500, 0, 200}, 0)) << "outside";
}

// One place in the middle of the image, with a normal at this angle.
std::unique_ptr<ContourPlaces> place_with_normal(double angle) {
  auto places = std::make_unique<ContourPlaces>();
  places->u[0] = 80;
  places->v[0] = 56;
  places->normal_u[0] = static_cast<float>(std::cos(angle));
  places->normal_v[0] = static_cast<float>(std::sin(angle));
  places->visible[0] = -1;
  return places;
}

// Blurred steps of a height across the normal, this far along it.
GrayImage steps(double angle, std::initializer_list<double> offsets_px, double height) {
  return GrayImage([=](int u, int v) {
    const double along = (u - 80) * std::cos(angle) + (v - 56) * std::sin(angle);
    double gray = 90;
    for (const double offset : offsets_px) gray += height / 2 * std::erf((along - offset) / 1.7);
    return gray;
  });
}

TEST(ContourKernels, AnEdgeIsFoundToAFractionOfAPixel) {
  const auto edges = std::make_unique<ContourEdges>();
  for (const double angle : {0.0, 0.6, kPi / 2, 2.5}) {
    for (double offset = -3; offset <= 3; offset += 0.13) {
      const GrayImage gray = steps(angle, {offset}, 90);
      kKernels.match_edges(*place_with_normal(angle), 1, gray.map(), 6, *edges);
      ASSERT_EQ(-1, edges->found[0]) << offset;
      // Beyond a pixel the preference of what is near draws it in.
      EXPECT_NEAR(offset, edges->offset_px[0], std::abs(offset) < 1.3 ? 0.1 : 0.2) << angle;
    }
  }
}

TEST(ContourKernels, OfTwoEdgesTheNearerIsTaken) {
  const auto edges = std::make_unique<ContourEdges>();
  const GrayImage gray = steps(0, {-5, 1}, 50);
  kKernels.match_edges(*place_with_normal(0), 1, gray.map(), 8, *edges);
  EXPECT_NEAR(1, edges->offset_px[0], 0.1);
}

TEST(ContourKernels, NoEdgeIsFoundInNoiseBeyondTheRangeOrWhereNothingIsVisible) {
  const auto edges = std::make_unique<ContourEdges>();
  const auto found = [&](const GrayImage& gray, const ContourPlaces& places) {
    kKernels.match_edges(places, 1, gray.map(), 4, *edges);
    return edges->found[0] != 0;
  };
  const auto place = place_with_normal(0);
  EXPECT_TRUE(found(steps(0, {0}, 50), *place));
  EXPECT_FALSE(found(steps(0, {0}, 7), *place));
  EXPECT_FALSE(found(steps(0, {9}, 50), *place));
  EXPECT_FALSE(found(steps(kPi / 2, {0}, 50), *place)) << "along the normal";
  place->visible[0] = 0;
  EXPECT_FALSE(found(steps(0, {0}, 50), *place));
  EXPECT_EQ(0, edges->offset_px[0]);
}

TEST(ContourKernels, DerivativesAreThoseOfTheProjection) {
  const Vec3 centre(5, -8, 190), p(20, 12, 205);
  const auto places = place_with_normal(0.7);
  const auto edges = std::make_unique<ContourEdges>();
  places->x[0] = static_cast<float>(p.x());
  places->y[0] = static_cast<float>(p.y());
  places->z[0] = static_cast<float>(p.z());
  edges->found[0] = -1;
  edges->offset_px[0] = -0.5f;
  constexpr double kFx = 210, kFy = 190;
  PinholeF camera = pinhole_of(kFx, 160, 112);
  camera.fy = static_cast<float>(kFy);
  const float at[3] = {5, -8, 190};
  EquationSums sums{};
  kKernels.contour_equations(*places, *edges, 1, at, camera, 1e4f, sums);
  ASSERT_EQ(1, sums.count);
  EXPECT_NEAR(0.25, sums.cost, 1e-5);
  const auto along_normal = [&](const Vec6d& by) {
    const Vec3 q = rotation_from_vector(by.head<3>()) * (p - centre) + centre + by.tail<3>();
    return std::cos(0.7) * kFx * q.x() / q.z() + std::sin(0.7) * kFy * q.y() / q.z();
  };
  for (int k = 0; k < 6; ++k) {
    const Vec6d step = 1e-5 * Vec6d::Unit(k);
    const double derivative = (along_normal(step) - along_normal(-step)) / 2e-5;
    EXPECT_NEAR(0.5 * derivative, sums.g[k], 1e-3 * std::max(1.0, std::abs(derivative))) << k;
  }
}

}  // namespace
}  // namespace binpick::simd
