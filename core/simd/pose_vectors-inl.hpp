// Vectors for the pose kernels, on the unit that is being compiled: points, samples as the camera
// sees them, what a depth image shows there, and partial sums. Included once per vector unit.
#if defined(BINPICK_SIMD_POSE_VECTORS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef BINPICK_SIMD_POSE_VECTORS_INL_HPP
#undef BINPICK_SIMD_POSE_VECTORS_INL_HPP
#else
#define BINPICK_SIMD_POSE_VECTORS_INL_HPP
#endif

#include <hwy/highway.h>

#include "simd/pose_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace binpick::simd::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR

using DF = hn::CappedTag<float, kPoseLanes>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;
using MF = hn::Mask<DF>;
constexpr DF kF;
constexpr DI kI;
// A vector unit of four lanes takes two steps for eight samples, each with partial sums of its own.
constexpr int kLanes = static_cast<int>(hn::MaxLanes(DF()));
constexpr int kParts = kPoseLanes / kLanes;

HWY_INLINE VF Set(float x) {
  return hn::Set(kF, x);
}
HWY_INLINE VF Square(VF x) {
  return hn::Mul(x, x);
}

struct V3 {
  VF x, y, z;
};
HWY_INLINE VF Dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE V3 Cross(const V3& a, const V3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE V3 Minus(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

// first, first + 1, ... Iota alone writes its lanes to memory where `first` is no constant.
HWY_INLINE VI CountedFrom(int first) {
  return hn::Add(hn::Iota(kI, 0), hn::Set(kI, first));
}
// The samples of one step that are there.
HWY_INLINE MF Present(int first, int count) {
  return hn::RebindMask(kF, hn::Lt(CountedFrom(first), hn::Set(kI, count)));
}

HWY_INLINE V3 Turned(const PoseF& T, const V3& p) {
  const auto row = [&](int k) {
    return hn::Add(hn::Add(hn::Mul(Set(T.R[k]), p.x), hn::Mul(Set(T.R[k + 1]), p.y)),
                   hn::Mul(Set(T.R[k + 2]), p.z));
  };
  return {row(0), row(3), row(6)};
}
HWY_INLINE V3 Direction(const SampleArrays& s, int i) {
  return {hn::LoadU(kF, s.dx + i), hn::LoadU(kF, s.dy + i), hn::LoadU(kF, s.dz + i)};
}

// Samples as the camera sees them.
struct Seen {
  V3 arm;  // from the part's centre
  V3 p, d;
};
HWY_INLINE Seen See(const SampleArrays& s, int i, const PoseF& T) {
  const V3 arm =
      Turned(T, {hn::LoadU(kF, s.x + i), hn::LoadU(kF, s.y + i), hn::LoadU(kF, s.z + i)});
  return {arm,
          {hn::Add(arm.x, Set(T.t[0])), hn::Add(arm.y, Set(T.t[1])), hn::Add(arm.z, Set(T.t[2]))},
          Turned(T, Direction(s, i))};
}

struct Measured {
  VI u, v, pixel;  // pixel 0 where outside
  MF inside, has;
  VF z;  // 0: nothing
};
HWY_INLINE Measured Measure(const DepthMap& m, const V3& p, MF present) {
  const VF iz = hn::Div(Set(1), p.z), low = Set(-0.5f), half = Set(0.5f);
  const VF u = hn::Add(hn::Mul(hn::Mul(p.x, iz), Set(m.camera.fx)), Set(m.camera.cx));
  const VF v = hn::Add(hn::Mul(hn::Mul(p.y, iz), Set(m.camera.fy)), Set(m.camera.cy));
  Measured out;
  out.inside = hn::And(hn::And(present, hn::And(hn::Ge(u, low), hn::Ge(v, low))),
                       hn::And(hn::Lt(u, Set(static_cast<float>(m.width) - 0.5f)),
                               hn::Lt(v, Set(static_cast<float>(m.height) - 0.5f))));
  out.u = hn::ConvertTo(kI, hn::IfThenElseZero(out.inside, hn::Add(u, half)));
  out.v = hn::ConvertTo(kI, hn::IfThenElseZero(out.inside, hn::Add(v, half)));
  out.pixel = hn::Add(hn::Mul(out.v, hn::Set(kI, m.stride)), out.u);
  out.z = hn::IfThenElseZero(out.inside, hn::GatherIndex(kF, m.depth_mm, out.pixel));
  out.has = hn::Gt(out.z, hn::Zero(kF));
  return out;
}

HWY_INLINE VF AlongNormal(const DepthMap& m, const Measured& at, const V3& p, const V3& n) {
  const VF u = hn::ConvertTo(kF, at.u), v = hn::ConvertTo(kF, at.v);
  const V3 q{hn::Mul(hn::Mul(hn::Sub(u, Set(m.camera.cx)), Set(m.camera.inverse_fx)), at.z),
             hn::Mul(hn::Mul(hn::Sub(v, Set(m.camera.cy)), Set(m.camera.inverse_fy)), at.z), at.z};
  return Dot(n, Minus(q, p));
}

HWY_INLINE VF GemanMcClure(VF residual, float scale) {
  const VF k = hn::Add(Set(1), hn::Mul(hn::Mul(residual, residual), Set(4 / (scale * scale))));
  return hn::Div(Set(1), hn::Mul(k, k));
}

// The lanes of all parts, as the scalar code adds them.
HWY_INLINE float LaneSum(const VF (&parts)[kParts]) {
  alignas(32) float lanes[kPoseLanes];
  for (int part = 0; part < kParts; ++part) hn::Store(parts[part], kF, lanes + part * kLanes);
  return lane_sum(lanes);
}
HWY_INLINE void Clear(VF (&parts)[kParts]) {
  for (VF& part : parts) part = hn::Zero(kF);
}

struct PartialSums {
  VF H[21][kParts], g[6][kParts], cost[kParts];
  int count = 0;

  HWY_INLINE PartialSums() {
    for (auto& h : H) Clear(h);
    for (auto& x : g) Clear(x);
    Clear(cost);
  }
  HWY_INLINE void Add(int part, MF used, const V3& arm, const V3& n, VF residual, VF weight) {
    const V3 turn = Cross(arm, n);
    const VF J[6] = {turn.x, turn.y, turn.z, n.x, n.y, n.z};
    const VF w = hn::IfThenElseZero(used, weight);
    int k = 0;
    for (int column = 0; column < 6; ++column) {
      const VF weighted = hn::Mul(w, J[column]);
      for (int row = column; row < 6; ++row, ++k)
        H[k][part] = hn::Add(H[k][part], hn::Mul(weighted, J[row]));
      g[column][part] = hn::Add(g[column][part], hn::Mul(weighted, residual));
    }
    cost[part] = hn::Add(cost[part], hn::Mul(hn::Mul(w, residual), residual));
    count += static_cast<int>(hn::CountTrue(kF, used));
  }
  HWY_INLINE void Into(EquationSums& out) const {
    for (int k = 0; k < 21; ++k) out.H[k] += LaneSum(H[k]);
    for (int k = 0; k < 6; ++k) out.g[k] += LaneSum(g[k]);
    out.cost += LaneSum(cost);
    out.count += count;
  }
};

// Four bytes at each byte offset.
HWY_INLINE VI GatherBytes(const std::uint8_t* base, VI offset) {
#if HWY_TARGET <= HWY_AVX2
  return hn::GatherOffset(kI, reinterpret_cast<const std::int32_t*>(base), offset);
#else
  alignas(32) std::int32_t at[kLanes], word[kLanes];
  hn::Store(offset, kI, at);
  for (int k = 0; k < kLanes; ++k) __builtin_memcpy(word + k, base + at[k], sizeof(std::int32_t));
  return hn::Load(kI, word);
#endif
}

#endif  // HWY_SCALAR

}  // namespace binpick::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
