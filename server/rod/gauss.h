#pragma once

#include "math/quadrature.h"

namespace mane::rod {

/// Points of the inertia integrals in each element: exact to round-off for gently bent elements, and
/// too few for a tightly wound one is inaccurate, never unstable (rod.md, Quadrature).
inline constexpr int kGaussPoints = 4;

/// The rule of kGaussPoints nodes on [0, 1].
[[nodiscard]] inline const math::Quadrature& Gauss() {
  static const math::Quadrature rule = math::GaussLegendre(kGaussPoints);
  return rule;
}

}  // namespace mane::rod
