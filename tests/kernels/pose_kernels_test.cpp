// Every pose kernel on every vector unit of this machine against the scalar function, bit for bit.
#include "simd/pose_kernels.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

#include "each_isa.hpp"
#include "pose_inputs.hpp"

namespace binpick::simd {
namespace {

constexpr double kRadius_mm = 40;

// All counts around the steps of every vector unit, and typical ones.
std::vector<int> counts_up_to(int most) {
  std::vector<int> counts;
  for (int i = 0; i <= 2 * kPoseLanes + 1; ++i) counts.push_back(i);
  for (const int i : {63, 100, most - kPoseLanes - 1, most - 3, most}) counts.push_back(i);
  return counts;
}

// Outputs that a kernel fills are made of guards before.
constexpr int kGuardByte = 0x5B;
template <class T>
std::unique_ptr<T> guarded() {
  static_assert(std::is_trivially_copyable_v<T>);
  auto out = std::make_unique<T>();
  std::memset(out.get(), kGuardByte, sizeof(T));
  return out;
}

// `count` elements alike, bit for bit, and nothing written beyond the padded count. No number is
// no number: which one a quotient gives is not specified.
template <class T, std::size_t N>
void expect_same(const T (&expected)[N], const T (&found)[N], int count, const char* what) {
  for (int i = 0; i < count; ++i) {
    if (expected[i] != expected[i] && found[i] != found[i]) continue;
    ASSERT_EQ(0, std::memcmp(expected + i, found + i, sizeof(T)))
        << what << ' ' << i << " of " << count << ": " << expected[i] << ' ' << found[i];
  }
  T guard;
  std::memset(&guard, kGuardByte, sizeof(T));
  for (std::size_t i = padded_samples(static_cast<std::uint64_t>(count)); i < N; ++i)
    ASSERT_EQ(0, std::memcmp(&guard, found + i, sizeof(T))) << what << " beyond its end at " << i;
}

void expect_same(const EquationSums& a, const EquationSums& b, int count) {
  for (int k = 0; k < 21; ++k) ASSERT_EQ(0, std::memcmp(a.H + k, b.H + k, 4)) << count << ' ' << k;
  for (int k = 0; k < 6; ++k) ASSERT_EQ(0, std::memcmp(a.g + k, b.g + k, 4)) << count << ' ' << k;
  ASSERT_EQ(0, std::memcmp(&a.cost, &b.cost, 4)) << count;
  ASSERT_EQ(a.count, b.count) << count;
}

// How often a case came up that a test has to see.
struct Seen {
  int used = 0, unused = 0;
};

class PoseKernelsOf : public EachIsa {
 protected:
  // `compare(samples, pose, depth)` on all counts, with poses in sight, at the camera and beside
  // the image.
  template <class Compare>
  void on_all_surfaces(Compare&& compare) {
    for (const int count : counts_up_to(kSurfaceSamplesMax)) {
      for (int i = 0; i < 12; ++i) {
        const PoseSamples samples(count, kRadius_mm, random);
        PoseF T = i % 4 == 3 ? pose_at_the_camera(random) : pose_in_sight(random);
        if (i == 6) T.t[0] = 1e7f;
        const DepthImage depth(static_cast<double>(T.t[2]), 10, random);
        compare(samples.arrays(), T, depth.map());
        if (HasFatalFailure()) return;
      }
    }
  }

  // Contour samples placed by the specification.
  std::unique_ptr<ContourPlaces> placed(const SampleArrays& contour, const PoseF& T,
                                        const GrayMap& gray, int range_px) {
    const DepthImage depth(205, 10, random);
    auto places = std::make_unique<ContourPlaces>();
    scalar.place_contour(contour, T, gray, depth.map(), static_cast<float>(range_px + 3), 15,
                         *places);
    return places;
  }

  // `compare(places, count, gray, range)` on all counts and ranges, on noise and on edges.
  template <class Compare>
  void on_all_contours(Compare&& compare) {
    const GrayImage images[] = {GrayImage::noise(random), GrayImage::edges(random)};
    int range_px = 1;
    for (const int count : counts_up_to(kContourSamplesMax)) {
      for (int i = 0; i < 6; ++i) {
        range_px = range_px < kEdgeRangePxMax ? range_px + 1 : 2;
        const PoseSamples samples(count, kRadius_mm, random);
        const GrayMap gray = images[i % 2].map();
        const PoseF T = i == 5 ? pose_at_the_camera(random) : pose_in_sight(random);
        compare(*placed(samples.arrays(), T, gray, range_px), count, gray, range_px);
        if (HasFatalFailure()) return;
      }
    }
  }

  const PoseKernels& kernels = table.pose;
  const PoseKernels scalar = pose_kernels_scalar();
};

TEST_P(PoseKernelsOf, LookAtSurfaceAgrees) {
  Seen measured, inside;
  on_all_surfaces([&](const SampleArrays& surface, const PoseF& T, const DepthMap& depth) {
    const auto expected = guarded<SurfaceLook>(), found = guarded<SurfaceLook>();
    scalar.look_at_surface(surface, T, depth, *expected);
    kernels.look_at_surface(surface, T, depth, *found);
    expect_same(expected->pixel, found->pixel, surface.count, "pixel");
    expect_same(expected->offset_mm, found->offset_mm, surface.count, "offset");
    expect_same(expected->residual_mm, found->residual_mm, surface.count, "residual");
    for (int i = 0; i < surface.count; ++i) {
      ++(expected->pixel[i] >= 0 ? inside.used : inside.unused);
      ++(expected->offset_mm[i] < kNotMeasured ? measured.used : measured.unused);
    }
  });
  EXPECT_GT(std::min(inside.used, inside.unused), 1000);
  EXPECT_GT(measured.unused - inside.unused, 1000) << "holes";
}

TEST_P(PoseKernelsOf, SurfaceEquationsAgree) {
  Seen seen;
  on_all_surfaces([&](const SampleArrays& surface, const PoseF& T, const DepthMap& depth) {
    for (const float gate_mm : {0.5f, 10.0f, 1e6f}) {
      EquationSums expected{}, found{};
      // They add to what is there.
      expected.H[3] = found.H[3] = 2;
      expected.count = found.count = 1;
      scalar.surface_equations(surface, T, depth, gate_mm, expected);
      kernels.surface_equations(surface, T, depth, gate_mm, found);
      expect_same(expected, found, surface.count);
      seen.used += expected.count - 1;
      seen.unused += surface.count - expected.count + 1;
    }
  });
  EXPECT_GT(std::min(seen.used, seen.unused), 1000);
}

TEST_P(PoseKernelsOf, SurfaceAgreementAgrees) {
  int hidden = 0, contradicted = 0, agreeing = 0;
  double explained = 0;
  on_all_surfaces([&](const SampleArrays& surface, const PoseF& T, const DepthMap& depth) {
    const Vec3 d = random_direction(random);
    const float from[3] = {static_cast<float>(d.x()), static_cast<float>(d.y()),
                           static_cast<float>(d.z())};
    for (const SurfaceTolerance tolerance :
         {SurfaceTolerance{2, 8, 0.6f, 0.75f, 0.2f}, SurfaceTolerance{1e6f, 120, 0, 0.8f, 0}}) {
      const auto expected = guarded<SurfaceAgreement>(), found = guarded<SurfaceAgreement>();
      scalar.surface_agreement(surface, T, depth, tolerance, from, *expected);
      kernels.surface_agreement(surface, T, depth, tolerance, from, *found);
      ASSERT_EQ(0, std::memcmp(expected.get(), found.get(), sizeof(SurfaceAgreement)))
          << surface.count << ": " << expected->supported << ' ' << found->supported << ", "
          << expected->explained << ' ' << found->explained;
      hidden += expected->hidden;
      contradicted += expected->contradicted;
      agreeing += expected->agreeing;
      explained += static_cast<double>(expected->explained);
    }
  });
  EXPECT_GT(std::min({hidden, contradicted, agreeing}), 500);
  EXPECT_GT(explained, 1000);
}

TEST_P(PoseKernelsOf, PlaceContourAgrees) {
  Seen visible;
  const GrayImage gray = GrayImage::noise(random);
  for (const int count : counts_up_to(kContourSamplesMax)) {
    for (int i = 0; i < 12; ++i) {
      const PoseSamples samples(count, kRadius_mm, random);
      PoseF T = i % 4 == 3 ? pose_at_the_camera(random) : pose_in_sight(random);
      if (i == 6) T.t[1] = -1e7f;
      const DepthImage depth(static_cast<double>(T.t[2]), 10, random);
      const auto expected = guarded<ContourPlaces>(), found = guarded<ContourPlaces>();
      for (const auto& [of, out] : {std::pair(&scalar, expected.get()), {&kernels, found.get()}}) {
        of->place_contour(samples.arrays(), T, gray.map(), depth.map(), static_cast<float>(i + 3),
                          static_cast<float>(i), *out);
      }
      expect_same(expected->u, found->u, count, "u");
      expect_same(expected->v, found->v, count, "v");
      expect_same(expected->normal_u, found->normal_u, count, "normal u");
      expect_same(expected->normal_v, found->normal_v, count, "normal v");
      expect_same(expected->x, found->x, count, "x");
      expect_same(expected->y, found->y, count, "y");
      expect_same(expected->z, found->z, count, "z");
      expect_same(expected->visible, found->visible, count, "visible");
      if (HasFatalFailure()) return;
      for (int k = 0; k < count; ++k) ++(expected->visible[k] ? visible.used : visible.unused);
    }
  }
  EXPECT_GT(std::min(visible.used, visible.unused), 1000);
}

TEST_P(PoseKernelsOf, MatchEdgesAgrees) {
  Seen edges;
  int refined = 0;
  on_all_contours([&](const ContourPlaces& places, int count, const GrayMap& gray, int range_px) {
    const auto expected = guarded<ContourEdges>(), found = guarded<ContourEdges>();
    scalar.match_edges(places, count, gray, range_px, *expected);
    kernels.match_edges(places, count, gray, range_px, *found);
    expect_same(expected->found, found->found, count, "found");
    expect_same(expected->offset_px, found->offset_px, count, "offset");
    for (int i = 0; i < count; ++i) {
      ++(expected->found[i] ? edges.used : edges.unused);
      refined += expected->offset_px[i] != std::round(expected->offset_px[i]);
    }
  });
  EXPECT_GT(std::min(edges.used, edges.unused), 500);
  EXPECT_GT(refined, 500);
}

TEST_P(PoseKernelsOf, ContourEquationsAgree) {
  Seen seen;
  on_all_contours([&](const ContourPlaces& places, int count, const GrayMap& gray, int range_px) {
    const auto edges = std::make_unique<ContourEdges>();
    scalar.match_edges(places, count, gray, range_px, *edges);
    const float centre[3] = {3, -5, 201};
    EquationSums expected{}, found{};
    expected.g[2] = found.g[2] = 2;
    expected.cost = found.cost = 5;
    for (const auto& [of, out] : {std::pair(&scalar, &expected), {&kernels, &found}}) {
      of->contour_equations(places, *edges, count, centre, gray.camera,
                            static_cast<float>(range_px), *out);
    }
    expect_same(expected, found, count);
    seen.used += expected.count;
    seen.unused += count - expected.count;
  });
  EXPECT_GT(std::min(seen.used, seen.unused), 500);
}

TEST_P(PoseKernelsOf, NearestDirectionAgrees) {
  std::vector<int> counts = counts_up_to(2562);
  counts.erase(counts.begin());  // a model has viewpoints
  for (const int count : counts) {
    PoseSamples directions(count);
    for (int i = 0; i < count; ++i) directions.set(i, random_direction(random), Vec3::Zero());
    for (int i = 0; i < 20; ++i) {
      const Vec3 d = random_direction(random);
      const float wanted[3] = {static_cast<float>(d.x()), static_cast<float>(d.y()),
                               static_cast<float>(d.z())};
      ASSERT_EQ(scalar.nearest_direction(directions.arrays(), wanted),
                kernels.nearest_direction(directions.arrays(), wanted))
          << count;
    }
  }
}

TEST_P(PoseKernelsOf, OfEqualDirectionsTheFirstIsNearest) {
  const float up[3] = {0, 0, 1};
  for (int first = 0; first < 20; ++first) {
    for (int second = first + 1; second < 40; ++second) {
      PoseSamples directions(40);
      for (int i = 0; i < 40; ++i) directions.set(i, Vec3(0, 0.6, -0.8), Vec3::Zero());
      for (const int i : {first, second}) directions.set(i, Vec3::UnitZ(), Vec3::Zero());
      ASSERT_EQ(first, kernels.nearest_direction(directions.arrays(), up)) << second;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EachIsa, PoseKernelsOf, testing::ValuesIn(kAllIsas), isa_of_test);

}  // namespace
}  // namespace binpick::simd
