#pragma once

#include "math/quadrature.h"

namespace mane::rod {

/// Points of the inertia integrals in each element: the inertia is good to 5e-8 for an element of 1
/// rad and to 1e-4 at 3 rad. Too few for a tightly wound one is inaccurate, never unstable (rod.md,
/// Quadrature).
inline constexpr int kGaussPoints = 4;

/// The rule of kGaussPoints nodes on [0, 1].
[[nodiscard]] inline const math::Quadrature& Gauss() {
  static const math::Quadrature rule = math::GaussLegendre(kGaussPoints);
  return rule;
}

}  // namespace mane::rod
