#include <memory>

#include "bench/kernels/kernel_bench.hpp"
#include "kernels/pose_inputs.hpp"

namespace binpick::simd {
namespace {

constexpr int kPoses = 64, kViewpoints = 642;
constexpr int kEdgeRange_px = 6;

// A part of as many samples as a model has at most, at poses in sight of a small image.
struct PoseInputs {
  std::mt19937 random{7};
  PoseSamples surface{kSurfaceSamplesMax, 40, random};
  PoseSamples contour{kContourSamplesMax, 40, random};
  PoseSamples directions{kViewpoints, 1, random};
  DepthImage depth{200, 10, random};
  GrayImage gray = GrayImage::edges(random);
  std::vector<PoseF> poses;
  std::vector<ContourPlaces> places{kPoses};
  std::vector<ContourEdges> edges{kPoses};

  PoseInputs() {
    const PoseKernels scalar = pose_kernels_scalar();
    for (std::size_t i = 0; i < kPoses; ++i) {
      poses.push_back(pose_in_sight(random));
      scalar.place_contour(contour.arrays(), poses[i], gray.map(), depth.map(), kEdgeRange_px + 3,
                           15, places[i]);
      scalar.match_edges(places[i], kContourSamplesMax, gray.map(), kEdgeRange_px, edges[i]);
    }
  }
};

}  // namespace

void add_pose_kernels(const KernelTable& table) {
  const auto in = std::make_shared<PoseInputs>();
  const PoseKernels& k = table.pose;
  const auto add = [&](const char* name, const Traffic& traffic, auto call) {
    add_benchmark(std::string(name) + "/" + table.name, traffic,
                  [=](int i) { call(static_cast<std::size_t>(i % kPoses)); });
  };
  add("look_at_surface", {}, [=](std::size_t i) {
    SurfaceLook look;
    k.look_at_surface(in->surface.arrays(), in->poses[i], in->depth.map(), look);
    benchmark::DoNotOptimize(look);
  });
  add("surface_equations", {}, [=](std::size_t i) {
    EquationSums sums{};
    k.surface_equations(in->surface.arrays(), in->poses[i], in->depth.map(), 5, sums);
    benchmark::DoNotOptimize(sums);
  });
  add("surface_agreement", {}, [=](std::size_t i) {
    SurfaceAgreement agreement;
    k.surface_agreement(in->surface.arrays(), in->poses[i], in->depth.map(),
                        {2, 8, 0.6f, 0.75f, 0.2f}, {0, 0, -1}, agreement);
    benchmark::DoNotOptimize(agreement);
  });
  add("place_contour", {}, [=](std::size_t i) {
    ContourPlaces places;
    k.place_contour(in->contour.arrays(), in->poses[i], in->gray.map(), in->depth.map(),
                    kEdgeRange_px + 3, 15, places);
    benchmark::DoNotOptimize(places);
  });
  add("match_edges", {}, [=](std::size_t i) {
    ContourEdges edges;
    k.match_edges(in->places[i], kContourSamplesMax, in->gray.map(), kEdgeRange_px, edges);
    benchmark::DoNotOptimize(edges);
  });
  add("contour_equations", {}, [=](std::size_t i) {
    EquationSums sums{};
    k.contour_equations(in->places[i], in->edges[i], kContourSamplesMax, {0, 0, 200},
                        in->gray.map().camera, float{kEdgeRange_px}, sums);
    benchmark::DoNotOptimize(sums);
  });
  constexpr double kDirectionBytes = kViewpoints * 3 * sizeof(float);
  add("nearest_direction", {kDirectionBytes, kDirectionBytes}, [=](std::size_t i) {
    const float(&R)[9] = in->poses[i].R;
    benchmark::DoNotOptimize(k.nearest_direction(in->directions.arrays(), {R[0], R[1], R[2]}));
  });
}

}  // namespace binpick::simd
