#pragma once

#include <vector>

namespace mane::math {

/// Nodes and weights on [0, 1]; the weights sum to 1.
struct Quadrature {
  std::vector<double> nodes;
  std::vector<double> weights;
};

/// Gauss-Legendre rule of `points` >= 1 nodes: exact for polynomials of degree 2 points - 1.
[[nodiscard]] Quadrature GaussLegendre(int points);

}  // namespace mane::math
