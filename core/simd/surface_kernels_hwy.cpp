// The vector kernels of surfaces and viewing directions: this file is compiled once per vector unit
// by foreach_target. pose_kernels.hpp states what each function does; the scalar code is what it
// must agree with bit for bit, so every product and sum stands in the same order here.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/surface_kernels_hwy.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/pose_vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace binpick::simd::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR  // the build's baseline may be this; the specification serves

void SetSurfaceKernels(PoseKernels&) {}

#else

void LookAtSurface(const SampleArrays& surface, const PoseF& T, const DepthMap& depth,
                   SurfaceLook& out) {
  for (int i = 0; i < surface.count; i += kLanes) {
    const Seen s = See(surface, i, T);
    const Measured m = Measure(depth, s.p, Present(i, surface.count));
    const VF none = Set(kNotMeasured);
    hn::Store(hn::IfThenElse(hn::RebindMask(kI, m.inside), m.pixel, hn::Set(kI, -1)), kI,
              out.pixel + i);
    hn::Store(hn::IfThenElse(m.has, hn::Sub(m.z, s.p.z), none), kF, out.offset_mm + i);
    hn::Store(hn::IfThenElse(m.has, AlongNormal(depth, m, s.p, s.d), none), kF,
              out.residual_mm + i);
  }
}

void SurfaceEquations(const SampleArrays& surface, const PoseF& T, const DepthMap& depth,
                      float gate_mm, EquationSums& out) {
  PartialSums sums;
  const VF gate = Set(gate_mm), ray_gate = Set(3 * gate_mm);
  for (int i = 0; i < surface.count; i += kLanes) {
    const Seen s = See(surface, i, T);
    const Measured m = Measure(depth, s.p, Present(i, surface.count));
    const VF r = hn::Sub(hn::Zero(kF), AlongNormal(depth, m, s.p, s.d));
    const MF near =
        hn::And(hn::Le(hn::Abs(r), gate), hn::Le(hn::Abs(hn::Sub(m.z, s.p.z)), ray_gate));
    const MF used = hn::And(hn::And(m.has, hn::Lt(Dot(s.d, s.p), hn::Zero(kF))), near);
    if (hn::AllFalse(kF, used)) continue;
    const VF residual = hn::IfThenElseZero(used, r);
    sums.Add(i / kLanes % kParts, used, s.arm, s.d, residual, GemanMcClure(residual, gate_mm));
  }
  sums.Into(out);
}

HWY_INLINE VF NormalAgreement(const DepthMap& m, VI pixel, const V3& p, const V3& n,
                              VF inverse_norm) {
  const VF x = hn::GatherIndex(kF, m.normal_x, pixel), y = hn::GatherIndex(kF, m.normal_y, pixel);
  const VF z =
      hn::Sub(hn::Zero(kF),
              hn::Sqrt(hn::Max(hn::Sub(hn::Sub(Set(1), Square(x)), Square(y)), hn::Zero(kF))));
  const V3 ray{hn::Mul(p.x, inverse_norm), hn::Mul(p.y, inverse_norm), hn::Mul(p.z, inverse_norm)};
  const V3 across{hn::Mul(ray.x, z), hn::Mul(ray.y, z),
                  hn::Sub(hn::Zero(kF), hn::Add(hn::Mul(ray.y, y), hn::Mul(ray.x, x)))};
  const VF k = hn::Div(Set(1), hn::Add(Set(1), ray.z));
  const V3 turned{hn::Add(hn::Add(x, across.x), hn::Mul(hn::Mul(ray.x, across.z), k)),
                  hn::Add(hn::Add(y, across.y), hn::Mul(hn::Mul(ray.y, across.z), k)),
                  hn::Sub(hn::Add(z, across.z),
                          hn::Mul(hn::Add(hn::Mul(ray.y, across.y), hn::Mul(ray.x, across.x)), k))};
  const auto byte = hn::And(GatherBytes(m.normal_valid, pixel), hn::Set(kI, 255));
  const MF valid = hn::RebindMask(kF, hn::Ne(byte, hn::Zero(kI)));
  return hn::IfThenElse(valid, Dot(n, turned), Set(1));
}

void MeasureAgreement(const SampleArrays& surface, const PoseF& T, const DepthMap& depth,
                      const SurfaceTolerance& tolerance, const float (&from)[3],
                      SurfaceAgreement& out) {
  out = {};
  VF supported[kParts], explained[kParts];
  Clear(supported);
  Clear(explained);
  const VF conflict = Set(tolerance.conflict_mm), behind = Set(-tolerance.conflict_mm);
  const VF narrowing = Set(1 / (16 * tolerance.fit_mm * tolerance.fit_mm)), zero = hn::Zero(kF);
  const VF normal_from = Set(tolerance.normal_cos_from), normals_min = Set(tolerance.normals_min),
           normal_scale = Set(1 / (tolerance.normal_cos_to - tolerance.normal_cos_from));
  const V3 towards{Set(from[0]), Set(from[1]), Set(from[2])};
  for (int i = 0; i < surface.count; i += kLanes) {
    const Seen s = See(surface, i, T);
    const Measured m = Measure(depth, s.p, Present(i, surface.count));
    const VF r = AlongNormal(depth, m, s.p, s.d);
    const MF hidden = hn::And(m.has, hn::And(hn::Lt(m.z, s.p.z), hn::Gt(r, conflict)));
    const MF contradicted = hn::And(m.has, hn::And(hn::Gt(m.z, s.p.z), hn::Lt(r, behind)));
    const MF agreeing = hn::AndNot(hn::Or(hidden, contradicted), m.has);
    out.hidden += static_cast<int>(hn::CountTrue(kF, hidden));
    out.contradicted += static_cast<int>(hn::CountTrue(kF, contradicted));
    if (hn::AllFalse(kF, agreeing)) continue;
    out.agreeing += static_cast<int>(hn::CountTrue(kF, agreeing));
    const VF q = hn::Max(hn::Sub(Set(1), hn::Mul(Square(r), narrowing)), zero);
    const VF inverse_norm = hn::Div(Set(1), hn::Sqrt(Dot(s.p, s.p)));
    const VF facing_alike = NormalAgreement(depth, m.pixel, s.p, s.d, inverse_norm);
    const VF alike = hn::Min(
        hn::Max(hn::Mul(hn::Sub(facing_alike, normal_from), normal_scale), normals_min), Set(1));
    const VF support = hn::Mul(Square(Square(Square(q))), alike);
    const VF facing = hn::Sub(zero, hn::Mul(Dot(s.d, s.p), inverse_norm));
    const VF facing_then = hn::Max(Dot(Direction(surface, i), towards), Set(0.05f));
    const VF foreshortening = hn::Min(hn::Max(hn::Div(facing, facing_then), zero), Set(2));
    const int part = i / kLanes % kParts;
    supported[part] = hn::Add(supported[part], hn::IfThenElseZero(agreeing, support));
    explained[part] =
        hn::Add(explained[part], hn::IfThenElseZero(agreeing, hn::Mul(support, foreshortening)));
  }
  out.supported = LaneSum(supported);
  out.explained = LaneSum(explained);
}

int NearestDirection(const SampleArrays& directions, const float (&d)[3]) {
  const V3 wanted{Set(d[0]), Set(d[1]), Set(d[2])};
  VF best = Set(-2);
  VI index = hn::Zero(kI);
  for (int i = 0; i < directions.count; i += kLanes) {
    const V3 direction{hn::LoadU(kF, directions.x + i), hn::LoadU(kF, directions.y + i),
                       hn::LoadU(kF, directions.z + i)};
    const VF cosine = Dot(direction, wanted);
    const MF better = hn::And(Present(i, directions.count), hn::Gt(cosine, best));
    best = hn::IfThenElse(better, cosine, best);
    index = hn::IfThenElse(hn::RebindMask(kI, better), CountedFrom(i), index);
  }
  alignas(32) float cosines[kLanes];
  alignas(32) std::int32_t indices[kLanes];
  hn::Store(best, kF, cosines);
  hn::Store(index, kI, indices);
  int at = 0;
  for (int k = 1; k < kLanes; ++k) {
    const bool earlier = cosines[k] == cosines[at] && indices[k] < indices[at];
    if (cosines[k] > cosines[at] || earlier) at = k;
  }
  return indices[at];
}

void SetSurfaceKernels(PoseKernels& kernels) {
  kernels.look_at_surface = LookAtSurface;
  kernels.surface_equations = SurfaceEquations;
  kernels.surface_agreement = MeasureAgreement;
  kernels.nearest_direction = NearestDirection;
}

#endif  // HWY_SCALAR

}  // namespace binpick::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace binpick::simd {

HWY_EXPORT(SetSurfaceKernels);

PoseKernels pose_kernels_vector(std::size_t target_index) {
  PoseKernels kernels = pose_kernels_scalar();
  HWY_DISPATCH_TABLE(SetSurfaceKernels)[target_index](kernels);
  set_contour_kernels_vector(target_index, kernels);
  return kernels;
}

}  // namespace binpick::simd
#endif
