#include "math/quadrature.h"

#include <cmath>
#include <numbers>

#include "base/check.h"

namespace mane::math {

Quadrature GaussLegendre(int points) {
  MANE_CHECK(points >= 1);
  Quadrature rule;
  for (int i = points; i >= 1; --i) {
    // Newton's method on the Legendre polynomial P_n from a guess between its roots.
    double x = std::cos(std::numbers::pi * (i - 0.25) / (points + 0.5));
    double slope = 1;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double previous = 1, value = x;
      for (int k = 2; k <= points; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * previous) / k;
        previous = value;
        value = next;
      }
      slope = points * (x * value - previous) / (x * x - 1);
      const double step = value / slope;
      x -= step;
      if (std::abs(step) < 1e-16) break;
    }
    rule.nodes.push_back(0.5 * (1 + x));
    rule.weights.push_back(1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace mane::math
