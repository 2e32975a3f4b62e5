#pragma once

/// Stumpff functions and the frames they give (rod.md, B2, H2), lane by lane; only for sources that
/// define MANE_ISA.

#include "rod/batch_rows.h"

namespace mane::rod {
namespace MANE_ISA {

/// Stumpff functions at many arguments reduced together: series up to kReduced, then doublings,
/// each lane as many as its own angle needs, so that no lane depends on its neighbours.
template <typename T, typename V>
struct Reduction {
  static constexpr double kReduced = 2.5;
  static constexpr int kMost = 40;  // Angles up to 1e12 rad.
  V zeta;                           // |theta|^2
  V z;                              // The same over 4^doublings.
  V doublings;                      // Of each lane.
  int most;                         // Of any lane.
};

template <typename V>
struct Stumpff {
  V c0, c1, c2, c3, c4, c5, c6;
};

/// Evaluates them for W lanes.
template <typename T, int W>
struct StumpffOf : Lanewise<T, W> {
  using typename Lanewise<T, W>::V;
  using typename Lanewise<T, W>::Vec;
  using Lanewise<T, W>::All;

  /// What a reduction of |theta|^2 is good for: c_n(s^2 zeta) at any s in [0, 1].
  static Reduction<T, V> Reduce(const V& zeta);
  /// c_n(s^2 zeta), up to c5; with `six` also c6. `s` is one number or one per lane, in [0, 1].
  template <bool six, typename S>
  static Stumpff<V> Evaluate(const Reduction<T, V>& reduction, const S& s);
  /// The right frame of an element whose left one is R, by local angles (H2).
  static Frame<V> Next(const Frame<V>& R, const Vec& theta, const Stumpff<V>& c);

 private:
  template <bool six>
  static Stumpff<V> Series(const V& z);
  // c_n(z) by its power series, for z up to kReduced.
  template <int n>
  static V Power(const V& z);
};

template <typename T, int W>
[[gnu::always_inline]] inline Reduction<T, typename StumpffOf<T, W>::V> StumpffOf<T, W>::Reduce(
    const V& zeta) {
  Reduction<T, V> r{zeta, zeta, V{}, 0};
  for (auto large = r.z > T(r.kReduced); r.most < r.kMost && simd::MANE_ISA::Any(large);
       large = r.z > T(r.kReduced), ++r.most) {
    r.z = large ? r.z * T(0.25) : r.z;
    r.doublings = large ? r.doublings + T(1) : r.doublings;
  }
  return r;
}

// Coefficients (-1)^k / (n + 2k)! of c_n.
template <typename T, int n>
struct Coefficients {
  // The next term is below half a unit in the last place at kReduced.
  static constexpr int kTerms = sizeof(T) == 4 ? 5 : 10;
  T k[kTerms];
  constexpr Coefficients() : k() {
    double c = 1;
    for (int i = 2; i <= n; ++i) c /= i;
    for (int i = 0; i < kTerms; ++i) {
      k[i] = T(c);
      c /= -(n + 2 * i + 1.0) * (n + 2 * i + 2.0);
    }
  }
};

template <typename T, int W>
template <int n>
[[gnu::always_inline]] inline typename StumpffOf<T, W>::V StumpffOf<T, W>::Power(const V& z) {
  constexpr Coefficients<T, n> c;
  V sum = V{} + c.k[c.kTerms - 1];
  for (int i = c.kTerms - 2; i >= 0; --i) sum = sum * z + c.k[i];
  return sum;
}

template <typename T, int W>
template <bool six>
[[gnu::always_inline]] inline Stumpff<typename StumpffOf<T, W>::V> StumpffOf<T, W>::Series(
    const V& z) {
  Stumpff<V> c;
  if constexpr (six) {
    c.c6 = Power<6>(z);
    c.c4 = T(1.0 / 24) - z * c.c6;
  } else {
    c.c6 = V{};
    c.c4 = Power<4>(z);
  }
  c.c5 = Power<5>(z);
  c.c3 = T(1.0 / 6) - z * c.c5;
  c.c2 = T(0.5) - z * c.c4;
  c.c1 = T(1) - z * c.c3;
  c.c0 = T(1) - z * c.c2;
  return c;
}

template <typename T, int W>
template <bool six, typename S>
[[gnu::always_inline]] inline Stumpff<typename StumpffOf<T, W>::V> StumpffOf<T, W>::Evaluate(
    const Reduction<T, V>& reduction, const S& s) {
  const V whole = reduction.zeta * (s * s);
  if (reduction.most == 0) return Series<six>(whole);
  const auto wound = whole > T(reduction.kReduced);
  V z = wound ? reduction.z * (s * s) : whole;
  Stumpff<V> c = Series<six>(z);
  // Cosine and sine of the double angle, kept a pair of one: frames stay orthonormal and strands of
  // their length whatever the angle (rod.md, B2).
  for (int level = reduction.most; level > 0; --level) {
    const auto wanted = wound & (reduction.doublings >= T(level));
    const V sine2 = z * c.c1 * c.c1, scale = T(1.5) - T(0.5) * (c.c0 * c.c0 + sine2);
    const V scale2 = scale * scale;
    c.c1 = wanted ? scale2 * c.c0 * c.c1 : c.c1;
    c.c0 = wanted ? T(1) - T(2) * scale2 * sine2 : c.c0;
    z = wanted ? z * T(4) : z;
  }
  const V inverse = T(1) / (wound ? z : All(1));
  c.c2 = wound ? (T(1) - c.c0) * inverse : c.c2;
  c.c3 = wound ? (T(1) - c.c1) * inverse : c.c3;
  c.c4 = wound ? (T(0.5) - c.c2) * inverse : c.c4;
  c.c5 = wound ? (T(1.0 / 6) - c.c3) * inverse : c.c5;
  if constexpr (six) c.c6 = wound ? (T(1.0 / 24) - c.c4) * inverse : c.c6;
  return c;
}

template <typename T, int W>
[[gnu::always_inline]] inline Frame<typename StumpffOf<T, W>::V> StumpffOf<T, W>::Next(
    const Frame<V>& R, const Vec& q, const Stumpff<V>& c) {
  const Vec q1 = c.c1 * q, q2 = c.c2 * q;
  const V xy = q2.x * q.y, xz = q2.x * q.z, yz = q2.y * q.z;
  // Columns of exp [q] = c0 + c1 [q] + c2 q q^T.
  const Vec e0{c.c0 + q2.x * q.x, xy + q1.z, xz - q1.y};
  const Vec e1{xy - q1.z, c.c0 + q2.y * q.y, yz + q1.x};
  const Vec e2{xz + q1.y, yz - q1.x, c.c0 + q2.z * q.z};
  return {R * e0, R * e1, R * e2};
}

}  // namespace MANE_ISA
}  // namespace mane::rod
