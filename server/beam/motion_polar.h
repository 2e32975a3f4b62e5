#pragma once

/// Segments by zenith and azimuth, as published (beam.md, B7 to B9); only for sources that define
/// MANE_ISA.

#include "beam/motion_turns.h"
#include "simd/angles.h"

namespace mane::beam {
namespace MANE_ISA {

/// Hairs whose segments are given by angles and their steps, Equations::kPolar.
template <typename T, int W>
struct PolarSegment : Turns<T, W> {
  using Base = Turns<T, W>;
  using Base::Put;
  using Base::Row;
  using typename Base::V;
  using typename Base::Vec;
  static constexpr int kRows = layout::kPolarState;

  static constexpr T kAxis = T(layout::kAxis), kMostTurn = T(layout::kMostTurn);

  V t, f, t_step, f_step;
  Vec e;

  [[gnu::always_inline]] PolarSegment(const T* state, const T& carried)
      : t(Row(state, layout::kZenith)),
        f(Row(state, layout::kAzimuth)),
        t_step(carried * Row(state, layout::kZenithStep)),
        f_step(carried * Row(state, layout::kAzimuthStep)) {
    Take();
    e = AtAngles();
  }

  [[gnu::always_inline]] static Vec Direction(const T* state) {
    V st, ct, sf, cf;
    simd::MANE_ISA::SinCos<T>(Row(state, layout::kZenith), st, ct);
    simd::MANE_ISA::SinCos<T>(Row(state, layout::kAzimuth), sf, cf);
    return {st * sf, ct, st * cf};
  }
  [[gnu::always_inline]] Vec Step(const Load<V>& load, const Vec& F) {
    const V size = Sqrt(Dot(F, F));
    LeaveAxis(F, size);
    const Vec u = U(), v = Azimuthal();
    const Vec rides = Cross(load.head_step, AtAngles());
    const V lever = st < T(0) ? -st : st, x = load.bound * size;
    t_step = ((T(1) + Base::Momentum(x, Size(t_step))) * t_step + load.push * Dot(F, u) +
              load.friction * Dot(rides, u)) /
             (T(1) + load.drag + load.friction + x);
    f_step = ((T(1) + Base::Momentum(lever * x, Size(f_step))) * f_step +
              st * (load.push * Dot(F, v) + load.friction * Dot(rides, v))) /
             (T(1) + load.drag + st * st * load.friction + lever * x);
    t = simd::MANE_ISA::Wrapped<T>(t + t_step);
    f = simd::MANE_ISA::Wrapped<T>(f + f_step);
    Take();
    return AtAngles();
  }
  [[gnu::always_inline]] Vec LastStep() const { return t_step * U() + (f_step * st) * Azimuthal(); }
  [[gnu::always_inline]] void Fluctuate(const Vec& /*from*/, const Vec& to) {
    SetDirection(t == t, to);
  }
  template <typename M>
  [[gnu::always_inline]] void Correct(const M& moved, const Vec& to, const Vec& step) {
    SetDirection(moved, to);
    const Vec u = U(), v = Azimuthal();
    const auto plain = (st > kAxis) | (st < -kAxis);
    t_step = moved ? Dot(step, u) : t_step;
    const V turn = plain ? Dot(step, v) / (plain ? st : V{} + 1) : V{}, most = V{} + kMostTurn;
    f_step = moved ? (turn > most ? most : (turn < -most ? -most : turn)) : f_step;
  }
  /// What is kept of a direction that it was put to: that of the angles.
  [[gnu::always_inline]] Vec Kept(const Vec& /*to*/) const { return AtAngles(); }
  [[gnu::always_inline]] void Write(const Vec& /*to*/, T* state) const {
    Put(t, state, layout::kZenith), Put(f, state, layout::kAzimuth);
    Put(t_step, state, layout::kZenithStep), Put(f_step, state, layout::kAzimuthStep);
  }

 private:
  [[gnu::always_inline]] static V Size(const V& step) { return step < T(0) ? -step : step; }

  V st, ct, sf, cf;  // Sines and cosines of t and f.

  [[gnu::always_inline]] void Take() {
    simd::MANE_ISA::SinCos<T>(t, st, ct);
    simd::MANE_ISA::SinCos<T>(f, sf, cf);
  }
  [[gnu::always_inline]] Vec AtAngles() const { return {st * sf, ct, st * cf}; }
  // u and v of B7.
  [[gnu::always_inline]] Vec U() const { return {ct * sf, -st, ct * cf}; }
  [[gnu::always_inline]] Vec Azimuthal() const { return {cf, V{}, -sf}; }

  static float Angle(float y, float x) { return __builtin_atan2f(y, x); }
  static double Angle(double y, double x) { return __builtin_atan2(y, x); }
  // atan2, lane by lane: rare.
  static V Angles(const V& y, const V& x) {
    alignas(64) T a[W], b[W];
    simd::MANE_ISA::Store(y, a), simd::MANE_ISA::Store(x, b);
    for (int i = 0; i < W; ++i) a[i] = Angle(a[i], b[i]);
    return simd::MANE_ISA::Load<V>(a);
  }

  // Along the axis the plane of t is that of the axis and F: what of the step lies in it is kept.
  // Where F lies along the axis too, the plane stays.
  [[gnu::always_inline]] void LeaveAxis(const Vec& F, const V& size) {
    const V level = Sqrt(F.x * F.x + F.z * F.z);
    const auto axis = (st < kAxis) & (st > -kAxis) & (level > kAxis * size);
    if (!Any(axis)) return;
    const V inverse = T(1) / (axis ? level : V{} + 1);
    const V kept = inverse * (sf * F.x + cf * F.z);
    t = (axis & (kept < T(0))) ? -t : t;
    f = axis ? Angles(F.x, F.z) : f;
    t_step = axis ? kept * t_step : t_step;
    f_step = axis ? V{} : f_step;
    Take();
  }
  // The angles of `to`, of the two pairs those whose azimuth is nearer to the one before.
  template <typename M>
  [[gnu::always_inline]] void SetDirection(const M& which, const Vec& to) {
    const V level = Sqrt(to.x * to.x + to.z * to.z);
    const V sign = sf * to.x + cf * to.z < T(0) ? V{} - 1 : V{} + 1;
    t = which ? Angles(sign * level, to.y) : t;
    f = (which & (level > T(1e-9))) ? Angles(sign * to.x, sign * to.z) : f;
    Take();
  }
};

}  // namespace MANE_ISA
}  // namespace mane::beam
