#pragma once

/// Turning directions and the steps that go with them; only for sources that define MANE_ISA.

#include "beam/motion_layout.h"
#include "simd/angles.h"
#include "simd/lanewise.h"

namespace mane::beam {
namespace MANE_ISA {

using simd::MANE_ISA::Any;
using simd::MANE_ISA::Cross;
using simd::MANE_ISA::Dot;
using simd::MANE_ISA::Select;
using simd::MANE_ISA::Sqrt;

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
struct Turns : simd::MANE_ISA::Lanewise<T, W> {
  using Base = simd::MANE_ISA::Lanewise<T, W>;
  using typename Base::V;
  using typename Base::Vec;

  // Of squared lengths: what is less is nothing but rounding.
  static constexpr T kNothing = sizeof(T) == 4 ? T(1e-10) : T(1e-24);

  /// A uniform matrix by its rows, times a.
  [[gnu::always_inline]] static Vec Times(const T (&M)[9], const Vec& a) {
    return {M[0] * a.x + M[1] * a.y + M[2] * a.z, M[3] * a.x + M[4] * a.y + M[5] * a.z,
            M[6] * a.x + M[7] * a.y + M[8] * a.z};
  }
  [[gnu::always_inline]] static Vec TransposeTimes(const T (&M)[9], const Vec& a) {
    return {M[0] * a.x + M[3] * a.y + M[6] * a.z, M[1] * a.x + M[4] * a.y + M[7] * a.z,
            M[2] * a.x + M[5] * a.y + M[8] * a.z};
  }
  [[gnu::always_inline]] static Vec All3(const T (&a)[3]) {
    return {V{} + a[0], V{} + a[1], V{} + a[2]};
  }
  [[gnu::always_inline]] static Vec Scaled(const V& s, const Vec& a) {
    return {s * a.x, s * a.y, s * a.z};
  }
  /// a less its part along the unit vector e.
  [[gnu::always_inline]] static Vec Across(const Vec& a, const Vec& e) {
    return a - Scaled(Dot(a, e), e);
  }
  /// Of a length of about 1, to the square of what it lacks.
  [[gnu::always_inline]] static Vec Renormalised(const Vec& e) {
    return Scaled(T(1.5) - T(0.5) * Dot(e, e), e);
  }
  /// a over its length, or `otherwise` where it has none.
  [[gnu::always_inline]] static Vec Unit(const Vec& a, const Vec& otherwise) {
    const V square = Dot(a, a);
    const auto some = square > kNothing;
    const V inverse = T(1) / Sqrt(some ? square : V{} + 1);
    return Select(some, Scaled(inverse, a), otherwise);
  }
  /// Two unit vectors across the unit vector e and each other.
  [[gnu::always_inline]] static void Basis(const Vec& e, Vec& u, Vec& v) {
    const V one = V{} + 1, sign = e.z < T(0) ? -one : one;
    const V a = -one / (sign + e.z), b = e.x * e.y * a;
    u = {T(1) + sign * e.x * e.x * a, sign * b, -sign * e.x};
    v = {b, sign + e.y * e.y * a, -e.y};
  }

  /// Turns e along delta by 2 atan(|delta| / 2), and delta with it (B12).
  [[gnu::always_inline]] static void Turn(Vec& e, Vec& delta) {
    const V q = T(0.25) * Dot(delta, delta), inverse = T(1) / (T(1) + q);
    const V c = (T(1) - q) * inverse;
    const Vec turned = Scaled(c, e) + Scaled(inverse, delta);
    delta = Scaled(c, delta) - Scaled(T(4) * q * inverse, e);
    e = Renormalised(turned);
    delta = Across(delta, e);
  }
  /// delta, across e, turned as e is to `to`, along the shortest arc.
  [[gnu::always_inline]] static Vec Carried(const Vec& delta, const Vec& e, const Vec& to) {
    const V s = T(1) + Dot(e, to), share = Dot(delta, to) / (s > kNothing ? s : V{} + kNothing);
    return Across(delta - Scaled(share, e + to), to);
  }
  /// The step at `to` of a direction that came from `from` [rad]: the turned angle by its sine, to
  /// the fifth order of it, and never more than 1.25.
  [[gnu::always_inline]] static Vec Moved(const Vec& from, const Vec& to) {
    const Vec sine = Scaled(Dot(from, to), to) - from;
    const V q = Dot(sine, sine);
    return Across(Scaled(T(1) + q * (T(1.0 / 6) + T(3.0 / 40) * q), sine), to);
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
      e = Select(
          beyond,
          Renormalised(Scaled(V{} + segment.cos_turn, a) + Scaled(V{} + segment.sin_turn, b)), e);
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
    return Scaled(simd::MANE_ISA::Load<V>(part[0]), u) +
           Scaled(simd::MANE_ISA::Load<V>(part[1]), v);
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
