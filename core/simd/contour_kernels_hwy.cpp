// The vector kernels of contours: this file is compiled once per vector unit by
// foreach_target. pose_kernels.hpp states what each function does; the scalar code is what it must
// agree with bit for bit, so every product and sum stands in the same order here.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/contour_kernels_hwy.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/pose_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace binpick::simd::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR  // the build's baseline may be this; the specification serves

void SetContourKernels(PoseKernels&) {}

#else

void PlaceContour(const SampleArrays& contour, const PoseF& T, const GrayMap& gray,
                  const DepthMap& depth, float margin_px, float hidden_mm, ContourPlaces& out) {
  const PinholeF& camera = gray.camera;
  const VF margin = Set(margin_px), fx = Set(camera.fx), fy = Set(camera.fy), zero = hn::Zero(kF);
  const VF u_max = Set(static_cast<float>(gray.width - 2) - margin_px),
           v_max = Set(static_cast<float>(gray.height - 2) - margin_px);
  const VF length_min = Set((1e-12f * camera.fx) * camera.fx);
  for (int i = 0; i < contour.count; i += kLanes) {
    const Seen s = See(contour, i, T);
    const VF iz = hn::Div(Set(1), s.p.z), a = hn::Mul(s.p.x, iz), b = hn::Mul(s.p.y, iz);
    const VF u = hn::Add(hn::Mul(a, fx), Set(camera.cx)),
             v = hn::Add(hn::Mul(b, fy), Set(camera.cy));
    const VF along_u = hn::Mul(fx, hn::Sub(s.d.x, hn::Mul(a, s.d.z)));
    const VF along_v = hn::Mul(fy, hn::Sub(s.d.y, hn::Mul(b, s.d.z)));
    const VF length2 = hn::Add(Square(along_u), Square(along_v));
    const VF inverse = hn::Div(Set(1), hn::Sqrt(hn::Max(length2, length_min)));
    const Measured m = Measure(depth, s.p, Present(i, contour.count));
    const MF hidden = hn::And(m.has, hn::Lt(m.z, hn::Sub(s.p.z, Set(hidden_mm))));
    const MF inside = hn::And(hn::And(hn::Ge(u, margin), hn::Ge(v, margin)),
                              hn::And(hn::Le(u, u_max), hn::Le(v, v_max)));
    const MF visible = hn::AndNot(
        hidden, hn::And(hn::And(Present(i, contour.count), inside), hn::Gt(length2, length_min)));
    hn::Store(u, kF, out.u + i);
    hn::Store(v, kF, out.v + i);
    hn::Store(hn::Sub(zero, hn::Mul(along_v, inverse)), kF, out.normal_u + i);
    hn::Store(hn::Mul(along_u, inverse), kF, out.normal_v + i);
    hn::Store(s.p.x, kF, out.x + i);
    hn::Store(s.p.y, kF, out.y + i);
    hn::Store(s.p.z, kF, out.z + i);
    hn::Store(hn::VecFromMask(kI, hn::RebindMask(kI, visible)), kI, out.visible + i);
  }
}

HWY_INLINE VF GrayAt(const GrayMap& gray, VF u, VF v) {
  const VI iu = hn::ConvertTo(kI, u), iv = hn::ConvertTo(kI, v);
  const VF fu = hn::Sub(u, hn::ConvertTo(kF, iu)), fv = hn::Sub(v, hn::ConvertTo(kF, iv));
  const VI at = hn::Add(hn::Mul(iv, hn::Set(kI, gray.stride)), iu), byte = hn::Set(kI, 255);
  const auto row = [&](const std::uint8_t* pixels) {
    const VI word = GatherBytes(pixels, at);
    const VF first = hn::ConvertTo(kF, hn::And(word, byte));
    const VF second = hn::ConvertTo(kF, hn::And(hn::ShiftRight<8>(word), byte));
    return hn::Add(first, hn::Mul(fu, hn::Sub(second, first)));
  };
  const VF top = row(gray.pixels), bottom = row(gray.pixels + gray.stride);
  return hn::Add(top, hn::Mul(fv, hn::Sub(bottom, top)));
}

void MatchEdges(const ContourPlaces& places, int count, const GrayMap& gray, int range_px,
                ContourEdges& out) {
  const int steps = 2 * range_px + 3;
  for (int i = 0; i < count; i += kLanes) {
    const MF visible = hn::And(
        Present(i, count), hn::RebindMask(kF, hn::MaskFromVec(hn::Load(kI, places.visible + i))));
    VF best = hn::Zero(kF), offset = hn::Zero(kF);
    MF found = hn::Lt(best, best);
    if (!hn::AllFalse(kF, visible)) {
      // Places that are not visible look at the first pixel.
      const VF u = hn::IfThenElseZero(visible, hn::Load(kF, places.u + i));
      const VF v = hn::IfThenElseZero(visible, hn::Load(kF, places.v + i));
      const VF du = hn::IfThenElseZero(visible, hn::Load(kF, places.normal_u + i));
      const VF dv = hn::IfThenElseZero(visible, hn::Load(kF, places.normal_v + i));
      VF profile[2 * kEdgeRangePxMax + 3];
      for (int k = 0; k < steps; ++k) {
        const VF away = Set(static_cast<float>(k - range_px - 1));
        profile[k] = GrayAt(gray, hn::Add(u, hn::Mul(away, du)), hn::Add(v, hn::Mul(away, dv)));
      }
      const auto contrast = [&](int k) { return hn::Abs(hn::Sub(profile[k + 1], profile[k - 1])); };
      // The best contrast and its neighbours; at the ends, where one is missing, it is no peak.
      VF c = contrast(1), before = c, peak = c, left = c, right = c;
      for (int k = 1; k + 1 < steps; ++k) {
        const VF after = k + 2 < steps ? contrast(k + 1) : c;
        const float away = static_cast<float>(k - range_px - 1);
        const float share = away / static_cast<float>(range_px + 1);
        const VF value =
            hn::Mul(hn::Min(c, Set(kContrastMax)), Set(1 - (kFarEdgeLoss * share) * share));
        const MF better = hn::And(hn::Ge(c, Set(kContrastMin)), hn::Gt(value, best));
        const bool inner = k > 1 && k + 2 < steps;
        best = hn::IfThenElse(better, value, best);
        offset = hn::IfThenElse(better, Set(away), offset);
        peak = hn::IfThenElse(better, c, peak);
        left = hn::IfThenElse(better, inner ? before : c, left);
        right = hn::IfThenElse(better, inner ? after : c, right);
        found = hn::Or(found, better);
        before = c;
        c = after;
      }
      // To a fraction of a pixel: the vertex of the parabola through the three.
      const VF bend = hn::Sub(hn::Add(left, right), hn::Add(peak, peak));
      const VF vertex = hn::Min(
          hn::Max(hn::Div(hn::Mul(Set(0.5f), hn::Sub(left, right)), bend), Set(-0.5f)), Set(0.5f));
      offset = hn::IfThenElse(hn::Lt(bend, Set(-1e-3f)), hn::Add(offset, vertex), offset);
      found = hn::And(found, visible);
      offset = hn::IfThenElseZero(found, offset);
    }
    hn::Store(offset, kF, out.offset_px + i);
    hn::Store(hn::VecFromMask(kI, hn::RebindMask(kI, found)), kI, out.found + i);
  }
}

void ContourEquations(const ContourPlaces& places, const ContourEdges& edges, int count,
                      const float (&centre)[3], const PinholeF& camera, float range_px,
                      EquationSums& out) {
  PartialSums sums;
  const V3 middle{Set(centre[0]), Set(centre[1]), Set(centre[2])};
  for (int i = 0; i < count; i += kLanes) {
    const MF found = hn::And(Present(i, count),
                             hn::RebindMask(kF, hn::MaskFromVec(hn::Load(kI, edges.found + i))));
    if (hn::AllFalse(kF, found)) continue;
    const V3 p{hn::Load(kF, places.x + i), hn::Load(kF, places.y + i), hn::Load(kF, places.z + i)};
    const VF iz = hn::Div(Set(1), p.z);
    const VF a = hn::Mul(hn::Mul(hn::Load(kF, places.normal_u + i), Set(camera.fx)), iz);
    const VF b = hn::Mul(hn::Mul(hn::Load(kF, places.normal_v + i), Set(camera.fy)), iz);
    const VF c = hn::Sub(hn::Zero(kF), hn::Mul(hn::Add(hn::Mul(a, p.x), hn::Mul(b, p.y)), iz));
    // What was not found may be no number.
    const V3 n{hn::IfThenElseZero(found, a), hn::IfThenElseZero(found, b),
               hn::IfThenElseZero(found, c)};
    const VF r =
        hn::Sub(hn::Zero(kF), hn::IfThenElseZero(found, hn::Load(kF, edges.offset_px + i)));
    sums.Add(i / kLanes % kParts, found, Minus(p, middle), n, r, GemanMcClure(r, range_px));
  }
  sums.Into(out);
}

void SetContourKernels(PoseKernels& kernels) {
  kernels.place_contour = PlaceContour;
  kernels.match_edges = MatchEdges;
  kernels.contour_equations = ContourEquations;
}

#endif  // HWY_SCALAR

}  // namespace binpick::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace binpick::simd {

HWY_EXPORT(SetContourKernels);

void set_contour_kernels_vector(std::size_t target_index, PoseKernels& kernels) {
  HWY_DISPATCH_TABLE(SetContourKernels)[target_index](kernels);
}

}  // namespace binpick::simd
#endif
