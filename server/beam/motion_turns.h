#pragma once

/// Turning directions and the steps that go with them; only for sources that define MANE_ISA.

#include "beam/directions.h"
#include "beam/motion_layout.h"

namespace mane::beam {
namespace MANE_ISA {

/// What acts on a segment besides F.
template <typename V>
struct Load {
  V push;                               // dt^2 lambda
  V bound;                              // The same where the recurrences are bounded, else 0.
  V drag;                               // beta dt
  V friction;                           // lambda K tau dt
  simd::MANE_ISA::Vector<V> head_step;  // Rotation of the head [rad].
};

/// Directions e and steps delta across them, W hairs at a time.
template <typename T, int W>
struct Turns : Directions<T, W> {
  using Base = Directions<T, W>;
  using Base::Across;
  using Base::Basis;
  using Base::kNothing;
  using Base::Renormalised;
  using Base::Unit;
  using typename Base::V;
  using typename Base::Vec;

  /// How much more of a step of `length` [rad] is kept than a backward one keeps (B12).
  [[gnu::always_inline]] static V Momentum(const V& x, const V& length) {
    const V some = x / (T(1) + T(4) * x), left = T(1) - length;
    const V most = left > T(0) ? left / (length + T(1e-20)) : V{};
    return some < most ? some : most;
  }
  /// Turns e along delta by 2 atan(|delta| / 2), and delta with it (B12).
  [[gnu::always_inline]] static void Turn(Vec& e, Vec& delta) {
    const V q = T(0.25) * Dot(delta, delta), inverse = T(1) / (T(1) + q);
    const V c = (T(1) - q) * inverse;
    const Vec turned = c * e + inverse * delta;
    delta = c * delta - (T(4) * q * inverse) * e;
    e = Renormalised(turned);
    delta = Across(delta, e);
  }
  /// delta, across e, turned as e is to `to`, along the shortest arc.
  [[gnu::always_inline]] static Vec Carried(const Vec& delta, const Vec& e, const Vec& to) {
    const V s = T(1) + Dot(e, to), share = Dot(delta, to) / (s > kNothing ? s : V{} + kNothing);
    return Across(delta - share * (e + to), to);
  }
  /// The step at `to` of a direction that came from `from` [rad]: the turned angle by its sine, to
  /// the fifth order of it, and never more than 1.25.
  [[gnu::always_inline]] static Vec Moved(const Vec& from, const Vec& to) {
    const Vec sine = Dot(from, to) * to - from;
    const V q = Dot(sine, sine);
    return Across((T(1) + q * (T(1.0 / 6) + T(3.0 / 40) * q)) * sine, to);
  }

  /// `from` turned about as `before` is to `to`.
  [[gnu::always_inline]] static Vec TurnedAlong(const Vec& from, const Vec& before, const Vec& to) {
    return Unit(from + (to - before), from);
  }

  /// The joint between directions a and e: e no further from a than the segment may turn (B14).
  /// Returns which lanes were moved.
  [[gnu::always_inline]] static auto Bend(const layout::SegmentNumbers<T>& segment, const Vec& a,
                                          Vec& e) {
    const auto beyond = Dot(a, e) < V{} + segment.cos_turn;
    if (Any(beyond)) {
      Vec u, v;
      Basis(a, u, v);
      const Vec b = Unit(Across(e, a), u);
      e = Select(beyond, Renormalised((V{} + segment.cos_turn) * a + (V{} + segment.sin_turn) * b),
                 e);
    }
    return beyond;
  }

  /// The turn that B15 draws for a segment: across e, each of two parts in [-fluctuation,
  /// fluctuation].
  static Vec Drawn(const layout::MotionShape<T>& shape, const layout::MotionStep<T>& step, int lane,
                   int segment, const Vec& e) {
    alignas(64) T part[2][W];
    for (int axis = 0; axis < 2; ++axis) {
      for (int i = 0; i < W; ++i) {
        const uint32_t hair = step.first_hair + static_cast<uint32_t>(lane + i);
        const uint32_t draw = Mix(Mix(hair ^ step.keys[0]) ^
                                  (step.keys[1] + 2 * static_cast<uint32_t>(segment) + axis));
        // 24 bits, which both number types hold.
        part[axis][i] = shape.fluctuation * (static_cast<T>(draw >> 8) * T(0x1p-23) - T(1));
      }
    }
    Vec u, v;
    Basis(e, u, v);
    return simd::MANE_ISA::Load<V>(part[0]) * u + simd::MANE_ISA::Load<V>(part[1]) * v;
  }

 private:
  // A bijection of 32 bits each of which depends on all.
  static uint32_t Mix(uint32_t x) {
    x = (x ^ (x >> 16)) * 0x7feb352dU;
    x = (x ^ (x >> 15)) * 0x846ca68bU;
    return x ^ (x >> 16);
  }
};

}  // namespace MANE_ISA
}  // namespace mane::beam
