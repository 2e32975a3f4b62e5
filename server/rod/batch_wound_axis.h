#pragma once

/// What the unknowns of wound elements do to their axes (coil.md, C3), lane by lane; only for
/// sources that define MANE_ISA.

#include "rod/batch_recursion.h"

namespace mane::rod {
namespace MANE_ISA {

template <typename T, int W>
struct WoundAxis : Recursion<T, W> {
  using typename Recursion<T, W>::V;
  using typename Recursion<T, W>::Vec;
  using Lanewise<T, W>::Row;

  /// One element's axis and its derivatives by x = (u, b1, b2, xi).
  struct Axis {
    Vec beta;          ///< Twist and bends [rad].
    V stretch, slant;  ///< lambda and the other part of the tangent.
    V along, across;   ///< dbeta0 / du and / dxi
    V stretch_by_u, stretch_by_xi;

    /// dbeta/dt and dlambda/dt from dx/dt.
    [[nodiscard]] Vec AngleRates(const V (&v)[4]) const {
      return {along * v[0] + across * v[3], v[1], v[2]};
    }
    [[nodiscard]] V StretchRate(const V (&v)[4]) const {
      return stretch_by_u * v[0] + stretch_by_xi * v[3];
    }
  };

  /// @param constants  the element's. @param x  its unknowns.
  [[gnu::always_inline]] static Axis AxisOf(const T* constants, const V (&x)[4]) {
    const V winding = Row(constants, layout::kWinding), rise = Row(constants, layout::kRise);
    const V slant = Row(constants, layout::kSlant);
    const V u = winding + x[0], xi = x[3];
    const V turn = simd::MANE_ISA::Sqrt(u * u + xi * xi + T(1e-30)), inverse = T(1) / turn;
    Axis axis;
    // turn - W, without its cancellation where a coil winds often.
    axis.beta = {(x[0] * (winding + u) + xi * xi) / (turn + winding), x[1], x[2]};
    axis.along = u * inverse;
    axis.across = xi * inverse;
    axis.stretch = rise * axis.along + slant * axis.across;
    axis.slant = slant * axis.along - rise * axis.across;
    const V rate = axis.slant * inverse;
    axis.stretch_by_u = -rate * axis.across;
    axis.stretch_by_xi = rate * axis.along;
    return axis;
  }
};

}  // namespace MANE_ISA
}  // namespace mane::rod
