#pragma once

/// How nodes are kept out of a hull, lane by lane (beam.md, B6); only for sources that define
/// MANE_ISA.
///
/// A `Ball` tells where the hull is the unit ball, E = |y|^2 - 1: of a point `At(p)` is y, of a way
/// `Along(v)` is M v, and `Slope(y)` is M^T y, half of E's gradient.

#include "beam/directions.h"

namespace mane::beam {
namespace MANE_ISA {

/// Turns segments out of a hull. Some 110 operations, 10 a halving.
template <typename T, int W>
struct KeepOut : Directions<T, W> {
  using Base = Directions<T, W>;
  using Base::Across;
  using Base::Larger;
  using Base::Smaller;
  using Base::Unit;
  using typename Base::V;
  using typename Base::Vec;

  /// E + 1 of a node.
  template <typename Ball>
  [[gnu::always_inline]] static V Level(const Ball& ball, const Vec& node) {
    const Vec y = ball.At(node);
    return Dot(y, y);
  }

  /// e; in the lanes of `inside`, whose node p + d e has a level below `reach`, that direction in
  /// the plane of `before` and e next to it whose node has not. Where none has, the normal at p.
  template <typename Ball, typename M>
  static Vec TurnedOut(const Ball& ball, const V& reach, const M& inside, const Vec& p, const V& d,
                       const Vec& before, const Vec& e) {
    const Vec y = ball.At(p), normal = Unit(ball.Slope(y), e);
    const Vec side = Side(before, e, normal);
    // t along which E grows fastest, s level with the hull on the side of e; of e the tangent of
    // half its angle from s away from t.
    const V along = Dot(normal, e), up = Dot(normal, side), none{};
    const V scale = T(1) / Sqrt(along * along + up * up);
    const V lying = scale * (up < none ? -up : up), sinking = -scale * along;
    const Vec t = (scale * along) * e + (scale * up) * side;
    const Vec s = lying * e + (up < none ? -sinking : sinking) * side;
    const V x_e = sinking / (T(1) + lying);

    // (1 + x^2)^2 (E + 1 - reach) at x.
    const Vec Ms = d * ball.Along(s), Mt = d * ball.Along(t);
    const V ss = Dot(Ms, Ms), st = Dot(Ms, Mt), tt = Dot(Mt, Mt);
    const V c = Dot(y, y) - reach;
    const V bs = T(2) * Dot(y, Ms), bt = T(2) * Dot(y, Mt);
    const V p0 = c + bs + ss, p1 = T(-2) * bt - T(4) * st, p2 = T(2) * (c - ss) + T(4) * tt;
    const V p3 = T(-2) * bt + T(4) * st, p4 = c - bs + ss;
    // Between s, or t where s is inside, and e.
    const auto level_is_out = (p0 >= none) & (x_e > none);
    V out = level_is_out ? none : V{} - 1, in = level_is_out ? x_e : Smaller(x_e, none);
    for (int i = 0; i < kHalvings; ++i) {
      const V x = T(0.5) * (out + in);
      const auto is_out = p0 + x * (p1 + x * (p2 + x * (p3 + x * p4))) >= none;
      out = is_out ? x : out;
      in = is_out ? in : x;
    }

    // What counts is the node itself.
    Vec turned = At(s, t, out);
    auto still = inside & (Level(ball, p + d * turned) < reach);
    for (V step = V{} + 4 * Base::kEpsilon; Any(still & (out > T(-1))); step = T(4) * step) {
      out = still ? Larger(out - step, V{} - 1) : out;
      turned = At(s, t, out);
      still = inside & (Level(ball, p + d * turned) < reach);
    }
    return Select(inside, Select(still, normal, turned), e);
  }

 private:
  // Of an arc of a quarter turn.
  static constexpr int kHalvings = Base::kIsFloat ? 20 : 50;
  // Square of what a plane must have of the normal.
  static constexpr T kLying = T(1e-4);

  // A unit vector across e, in its plane with `before`: or, where these are parallel or their plane
  // lies along the hull, with the normal.
  [[gnu::always_inline]] static Vec Side(const Vec& before, const Vec& e, const Vec& normal) {
    Vec any, other;
    Base::Basis(e, any, other);
    const Vec turned = Across(before, e);
    // Rounding leaves some of e in what was nearly parallel.
    const Vec side = Unit(Across(Unit(turned), e));
    const V along = Dot(normal, e), up = Dot(normal, side);
    const auto spans = (Dot(turned, turned) > Base::kNothing) & (along * along + up * up > kLying);
    const Vec upward = Unit(Across(Unit(Across(normal, e), any), e));
    return Select(spans, side, upward);
  }

  // At the angle from s away from t of whose half x is the tangent.
  [[gnu::always_inline]] static Vec At(const Vec& s, const Vec& t, const V& x) {
    const V q = x * x, over = T(1) / (T(1) + q);
    return Base::Renormalised(((T(1) - q) * over) * s - (T(2) * x * over) * t);
  }
};

}  // namespace MANE_ISA
}  // namespace mane::beam
