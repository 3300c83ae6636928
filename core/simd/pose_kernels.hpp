// The kernels of the pose steps, in single precision. Each exists as a scalar function, which is
// the specification and ships, and as one Highway source compiled for every vector unit. All give
// the same bits: products and sums are not fused, roots and quotients are exact, and a sum over
// samples is always eight partial sums (sample i belongs to sum i % 8), added in one order
// (lane_sum). Samples are padded to a multiple of eight (SampleArrays); output arrays have room for
// as many. Lengths in mm, pixels in px, camera axes unless stated.
#pragma once

#include <cstddef>
#include <cstdint>

#include "binpick/model/object_model.hpp"

namespace binpick::simd {

inline constexpr int kPoseLanes = kSampleLanes;

// x_cam = R x_obj + t; R row-major.
struct PoseF {
  float R[9];
  float t[3];
};

struct PinholeF {
  float fx, fy, cx, cy;
  float inverse_fx, inverse_fy;
};

// A depth image with fitted normals (unit vectors (x, y, -sqrt(1 - x^2 - y^2)) in the frames of
// their rays; normal_valid 0 where none was fitted). Depth 0 is no measurement. normal_valid is
// readable three bytes beyond its last pixel.
struct DepthMap {
  const float* depth_mm;
  const float* normal_x;
  const float* normal_y;
  const std::uint8_t* normal_valid;
  std::int32_t width, height, stride;  // stride in elements
  PinholeF camera;
};

// Readable three bytes beyond its last pixel.
struct GrayMap {
  const std::uint8_t* pixels;
  std::int32_t width, height, stride;
  PinholeF camera;
};

// Weighted least squares over a left increment about the part's centre (rotation vector, then
// shift): H = sum w J J^T, lower triangle by columns; g = sum w r J.
struct EquationSums {
  float H[21], g[6], cost;
  int count;
};

// What a depth image shows where each sample projects to.
struct SurfaceLook {
  alignas(
      32) std::int32_t pixel[kSurfaceSamplesMax];     // index of the nearest; -1: outside the image
  alignas(32) float offset_mm[kSurfaceSamplesMax];    // measured minus predicted depth;
                                                      // kNotMeasured where there is none
  alignas(32) float residual_mm[kSurfaceSamplesMax];  // along the sample's normal; kNotMeasured
};
inline constexpr float kNotMeasured = 1e30f;
using LookAtSurfaceFn = void (*)(const SampleArrays& surface, const PoseF& pose,
                                 const DepthMap& depth, SurfaceLook& out);

// Adds the point-to-plane residuals (mm) of samples that face the camera: those up to gate_mm, and
// up to 3 gate_mm along the ray, with Geman-McClure weights of scale gate_mm.
using SurfaceEquationsFn = void (*)(const SampleArrays& surface, const PoseF& pose,
                                    const DepthMap& depth, float gate_mm, EquationSums& out);

// How a surface agrees with the depth: counts, and sums over the samples that agree.
struct SurfaceAgreement {
  int hidden;        // measured nearer than predicted by more than conflict_mm
  int contradicted;  // measured farther by more than conflict_mm
  int agreeing;      // neither
  float supported;   // (1 - r^2 / (16 fit^2))^8, about exp(-r^2 / (2 fit^2)), times how well the
                     // normals agree: from normals_min to 1, linear in their cosine
  float explained;   // of that, times the sample's foreshortening over that in its own viewpoint
};
struct SurfaceTolerance {
  float fit_mm, conflict_mm;
  float normal_cos_from, normal_cos_to;  // of normals that agree not at all, and fully
  float normals_min;
};
// `from_obj`: unit vector from the part to the camera of the samples' viewpoint, object axes.
using SurfaceAgreementFn = void (*)(const SampleArrays& surface, const PoseF& pose,
                                    const DepthMap& depth, const SurfaceTolerance& tolerance,
                                    const float (&from_obj)[3], SurfaceAgreement& out);

// Where contour samples project to.
struct ContourPlaces {
  alignas(32) float u[kContourSamplesMax], v[kContourSamplesMax];  // px of the gray image
  alignas(32) float normal_u[kContourSamplesMax], normal_v[kContourSamplesMax];  // across; unit
  alignas(32) float x[kContourSamplesMax], y[kContourSamplesMax], z[kContourSamplesMax];
  alignas(32) std::int32_t visible[kContourSamplesMax];  // -1: inside the image by `margin_px`, and
                                                         // nothing nearer by hidden_mm; else 0
};
using PlaceContourFn = void (*)(const SampleArrays& contour, const PoseF& pose, const GrayMap& gray,
                                const DepthMap& depth, float margin_px, float hidden_mm,
                                ContourPlaces& out);

// The image edge beside each visible place: the strongest contrast (over two pixels, capped) along
// the normal, up to range_px to either side, nearer ones preferred, to a fraction of a pixel.
// Places have a margin of range_px + 3.
struct ContourEdges {
  alignas(32) float offset_px[kContourSamplesMax];     // along the normal; 0 where none was found
  alignas(32) std::int32_t found[kContourSamplesMax];  // -1 or 0
};
inline constexpr int kEdgeRangePxMax = 12;
using MatchEdgesFn = void (*)(const ContourPlaces& places, int count, const GrayMap& gray,
                              int range_px, ContourEdges& out);

// Adds the point-to-line residuals (px) of the edges found, with Geman-McClure weights of scale
// range_px. `centre`: of the part, camera axes.
using ContourEquationsFn = void (*)(const ContourPlaces& places, const ContourEdges& edges,
                                    int count, const float (&centre)[3], const PinholeF& camera,
                                    float range_px, EquationSums& out);

// Index of the unit vector nearest to a direction; of equal ones the first.
using NearestDirectionFn = int (*)(const SampleArrays& directions, const float (&direction)[3]);

struct PoseKernels {
  LookAtSurfaceFn look_at_surface;
  SurfaceEquationsFn surface_equations;
  SurfaceAgreementFn surface_agreement;
  PlaceContourFn place_contour;
  MatchEdgesFn match_edges;
  ContourEquationsFn contour_equations;
  NearestDirectionFn nearest_direction;
};

// The specification.
PoseKernels pose_kernels_scalar();
// Compiled for one vector unit; `target_index`: position in Highway's dispatch tables.
PoseKernels pose_kernels_vector(std::size_t target_index);
// The part of it that stands in a file of its own.
void set_contour_kernels_vector(std::size_t target_index, PoseKernels& kernels);

// The one order in which partial sums are added.
inline float lane_sum(const float (&sums)[kPoseLanes]) {
  return ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

// Contrast over two pixels below which an edge is noise, and above which it counts no more.
inline constexpr float kContrastMin = 8, kContrastMax = 60;
// What an edge loses at the end of the range for being far away.
inline constexpr float kFarEdgeLoss = 0.7f;

}  // namespace binpick::simd
