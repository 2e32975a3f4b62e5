#pragma once

/// Hair and the hull (beam.md, B6 and B13); only for sources that define MANE_ISA.
///
/// Points are in the hull's own coordinates y, in which it is the unit ball: E = |y|^2 - 1, and
/// half of E's gradient in world axes is the transpose of `to_hull` times y.

#include "beam/motion_turns.h"

namespace mane::beam {
namespace MANE_ISA {

template <typename T, int W>
struct AtHull : Turns<T, W> {
  using Base = Turns<T, W>;
  using Base::Across;
  using Base::Basis;
  using Base::Renormalised;
  using Base::Scaled;
  using Base::Times;
  using Base::TransposeTimes;
  using Base::Unit;
  using typename Base::V;
  using typename Base::Vec;

  /// What E of a node must reach, so that it does when computed otherwise.
  static constexpr T kMargin = sizeof(T) == 4 ? T(1e-5) : T(1e-11);

  /// F where segment ends at y, pushed into the hull close by: epsilon F (B13).
  [[gnu::always_inline]] static void Weaken(const layout::MotionShape<T>& shape,
                                            const layout::MotionStep<T>& step, const T& epsilon,
                                            const Vec& y, Vec& F) {
    const Vec g = TransposeTimes(step.to_hull, y);
    const V size = Sqrt(Dot(g, g));
    const auto close = Dot(y, y) - T(1) < shape.twice_near * size;
    const auto pushed = Dot(g, F) < shape.alpha * (size * Sqrt(Dot(F, F)));
    F = Scaled((close & pushed) ? V{} + epsilon : V{} + 1, F);
  }

  /// Lanes whose segment along e, of length d, ends inside the hull.
  [[gnu::always_inline]] static auto Inside(const layout::MotionStep<T>& step, const Vec& y0,
                                            const V& d, const Vec& e) {
    const Vec y = y0 + Scaled(d, Times(step.to_hull, e));
    return Dot(y, y) < V{} + (T(1) + kMargin);
  }

  /// Turns e of the lanes in `inside` out in the plane of a and e, as little as it takes (B6);
  /// where the segment begins inside, outward.
  template <typename M>
  static void TurnOut(const layout::MotionStep<T>& step, const M& inside, const Vec& y0, const V& d,
                      const Vec& a, Vec& e) {
    const Vec g = TransposeTimes(step.to_hull, y0);
    const Vec outward = Unit(g, e);
    Vec first, second;
    PlaneOf(outward, a, e, first, second);

    // In that plane: t along which E grows fastest, s across it on e's side, e at an angle psi from
    // s away from t.
    const V g0 = Dot(outward, first), g1 = Dot(outward, second);
    const V inverse = T(1) / Sqrt(g0 * g0 + g1 * g1);
    const Vec t = Scaled(inverse * g0, first) + Scaled(inverse * g1, second);
    Vec s = Scaled(inverse * g0, second) - Scaled(inverse * g1, first);
    V along = Dot(e, s);
    s = Select(along < T(0), -s, s);
    along = along < T(0) ? -along : along;
    const V against = -Dot(e, t);
    const V end = (against > T(0) ? against : V{}) / (T(1) + along);

    // E of the node at angle psi, as a polynomial of x = tan(psi / 2) over (1 + x^2)^2.
    const Vec Ms = Scaled(d, Times(step.to_hull, s)), Mt = Scaled(d, Times(step.to_hull, t));
    const V c = Dot(y0, y0) - (T(1) + kMargin), bs = T(2) * Dot(y0, Ms), bt = T(2) * Dot(y0, Mt);
    const V ss = Dot(Ms, Ms), st = Dot(Ms, Mt), tt = Dot(Mt, Mt);
    const V p0 = c + bs + ss, p1 = T(-2) * bt - T(4) * st, p2 = T(2) * (c - ss) + T(4) * tt;
    const V p3 = T(-2) * bt + T(4) * st, p4 = c - bs + ss;
    V low{}, high = end;
    for (int i = 0; i < kHalvings; ++i) {
      const V x = T(0.5) * (low + high);
      const auto out = p0 + x * (p1 + x * (p2 + x * (p3 + x * p4))) >= V{};
      low = out ? x : low;
      high = out ? high : x;
    }
    const V q = low * low, over = T(1) / (T(1) + q);
    const Vec turned = Scaled((T(1) - q) * over, s) - Scaled(T(2) * low * over, t);
    e = Select(inside, Select(p0 >= V{}, Renormalised(turned), outward), e);
  }

  /// `went`, of a segment that ends on the hull at y, without what of it goes into the hull, and
  /// not faster than `speed` (squared), both as seen from the head, with which it would go `rides`.
  [[gnu::always_inline]] static Vec Stopped(const layout::MotionStep<T>& step, const Vec& y,
                                            const Vec& e, const Vec& rides, const V& speed,
                                            const Vec& went) {
    const Vec n = Across(TransposeTimes(step.to_hull, y), e);
    const V square = Dot(n, n);
    Vec past = went - rides;
    const V into = Dot(past, n);
    const auto goes = (into < T(0)) & (square > Base::kNothing);
    past = Select(goes, past - Scaled(into / (goes ? square : V{} + 1), n), past);
    const V size = Dot(past, past);
    const auto faster = size > speed;
    return rides + Scaled(faster ? Sqrt(speed / (faster ? size : V{} + 1)) : V{} + 1, past);
  }

 private:
  // How often the bracket of an angle below a quarter turn is halved.
  static constexpr int kHalvings = 20;

  // Two orthonormal vectors that span a and e: or, where these are parallel, e and what is outward;
  // or, where the plane of both lies along the hull, outward and e.
  [[gnu::always_inline]] static void PlaneOf(const Vec& outward, const Vec& a, const Vec& e,
                                             Vec& first, Vec& second) {
    constexpr T kParallel = T(1e-6), kAlong = T(1e-4);
    Vec u, v;
    Basis(a, u, v);
    const Vec across = Across(e, a);
    first = a;
    second = Unit(Select(Dot(across, across) > kParallel, across, Across(outward, a)), u);
    const V g0 = Dot(outward, first), g1 = Dot(outward, second);
    const auto along = g0 * g0 + g1 * g1 < kAlong;
    Basis(outward, u, v);
    first = Select(along, outward, first);
    second = Select(along, Unit(Across(e, outward), u), second);
  }
};

}  // namespace MANE_ISA
}  // namespace mane::beam
