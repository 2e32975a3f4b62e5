#pragma once

/// Directions, lane by lane; only for sources that define MANE_ISA.

#include "simd/lanewise.h"

namespace mane::beam {
namespace MANE_ISA {

using simd::MANE_ISA::Any;
using simd::MANE_ISA::Cross;
using simd::MANE_ISA::Dot;
using simd::MANE_ISA::Select;
using simd::MANE_ISA::Sqrt;

/// What statics, dynamics and the hull share of vectors of W hairs.
template <typename T, int W>
struct Directions : simd::MANE_ISA::Lanewise<T, W> {
  using Base = simd::MANE_ISA::Lanewise<T, W>;
  using Base::All;
  using typename Base::V;
  using typename Base::Vec;

  static constexpr bool kIsFloat = sizeof(T) == 4;
  static constexpr T kEpsilon = kIsFloat ? T(0x1p-23) : T(0x1p-52);
  /// Of squared lengths of what was near 1: what is less is nothing but rounding.
  static constexpr T kNothing = kIsFloat ? T(1e-10) : T(1e-24);

  [[gnu::always_inline]] static Vec All(const T (&a)[3]) {
    return {V{} + a[0], V{} + a[1], V{} + a[2]};
  }
  /// A uniform matrix by its rows, times a.
  [[gnu::always_inline]] static Vec Times(const T (&M)[9], const Vec& a) {
    return {M[0] * a.x + M[1] * a.y + M[2] * a.z, M[3] * a.x + M[4] * a.y + M[5] * a.z,
            M[6] * a.x + M[7] * a.y + M[8] * a.z};
  }
  [[gnu::always_inline]] static Vec TransposeTimes(const T (&M)[9], const Vec& a) {
    return {M[0] * a.x + M[3] * a.y + M[6] * a.z, M[1] * a.x + M[4] * a.y + M[7] * a.z,
            M[2] * a.x + M[5] * a.y + M[8] * a.z};
  }
  [[gnu::always_inline]] static V Larger(const V& a, const V& b) { return a > b ? a : b; }
  [[gnu::always_inline]] static V Smaller(const V& a, const V& b) { return a < b ? a : b; }
  [[gnu::always_inline]] static V Size(const Vec& a) { return Sqrt(Dot(a, a)); }

  /// a less its part along the unit vector e.
  [[gnu::always_inline]] static Vec Across(const Vec& a, const Vec& e) { return a - Dot(a, e) * e; }
  /// a over its length, or `otherwise` where it has none.
  [[gnu::always_inline]] static Vec Unit(const Vec& a, const Vec& otherwise) {
    const V square = Dot(a, a);
    const auto some = square > kNothing;
    const V inverse = T(1) / Sqrt(some ? square : V{} + 1);
    return Select(some, inverse * a, otherwise);
  }
  /// a over its length, whatever that is; 0 of 0.
  [[gnu::always_inline]] static Vec Unit(const Vec& a) {
    return (T(1) / Sqrt(Larger(Dot(a, a), All(kTiny)))) * a;
  }
  /// Of a length of about 1, to the square of what it lacks.
  [[gnu::always_inline]] static Vec Renormalised(const Vec& e) {
    return (T(1.5) - T(0.5) * Dot(e, e)) * e;
  }
  /// Two unit vectors across the unit vector e and each other.
  [[gnu::always_inline]] static void Basis(const Vec& e, Vec& u, Vec& v) {
    const V one = V{} + 1, sign = e.z < T(0) ? -one : one;
    const V a = -one / (sign + e.z), b = e.x * e.y * a;
    u = {T(1) + sign * e.x * e.x * a, sign * b, -sign * e.x};
    v = {b, sign + e.y * e.y * a, -e.y};
  }

  /// A square that has an inverse.
  static constexpr double kTiny = 1e-30;
};

}  // namespace MANE_ISA
}  // namespace mane::beam
