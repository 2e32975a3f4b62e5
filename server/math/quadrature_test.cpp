// Properties of Gauss-Legendre rules on [0, 1]:
//   degree      exact for every monomial up to degree 2 n - 1, and not for 2 n
//   placement   nodes inside, ascending, symmetric; weights positive, of sum 1

#include "math/quadrature.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/check_failure.h"

namespace mane::math {
namespace {

double Integrate(const Quadrature& rule, int degree) {
  double sum = 0;
  for (size_t i = 0; i < rule.nodes.size(); ++i) {
    sum += rule.weights[i] * std::pow(rule.nodes[i], degree);
  }
  return sum;
}

TEST(QuadratureTest, ExactUpToDegreeTwiceNMinusOne) {
  for (int n = 1; n <= 64; ++n) {
    const Quadrature rule = GaussLegendre(n);
    for (int degree = 0; degree < 2 * n; ++degree) {
      // Nodes and weights are rounded; x^degree multiplies a node's relative rounding by the
      // degree.
      EXPECT_NEAR(Integrate(rule, degree) * (degree + 1), 1, 1e-15 * (10 + 2 * degree))
          << "n=" << n << " degree=" << degree;
    }
  }
}

TEST(QuadratureTest, ErrsAtDegreeTwiceNByTheKnownRemainder) {
  // The remainder for x^(2n) is (n!)^4 / ((2n + 1) ((2n)!)^2).
  for (int n = 1; n <= 10; ++n) {
    double ratio = 1;  // (n!)^2 / (2n)!
    for (int k = 1; k <= n; ++k) ratio *= static_cast<double>(k) / (n + k);
    const double remainder = ratio * ratio / (2 * n + 1);
    const double error = 1.0 / (2 * n + 1) - Integrate(GaussLegendre(n), 2 * n);
    EXPECT_NEAR(error, remainder, 1e-15) << n;
    EXPECT_GT(error, 0.5 * remainder - 1e-16) << n;
  }
}

TEST(QuadratureTest, NodesAscendSymmetricallyInsideAndWeightsArePositive) {
  for (int n = 1; n <= 64; ++n) {
    const Quadrature rule = GaussLegendre(n);
    ASSERT_EQ(rule.nodes.size(), static_cast<size_t>(n));
    ASSERT_EQ(rule.weights.size(), static_cast<size_t>(n));
    double previous = 0, sum = 0;
    for (int i = 0; i < n; ++i) {
      EXPECT_GT(rule.nodes[i], previous);
      EXPECT_LT(rule.nodes[i], 1);
      EXPECT_GT(rule.weights[i], 0);
      EXPECT_NEAR(rule.nodes[i] + rule.nodes[n - 1 - i], 1, 1e-15);
      EXPECT_NEAR(rule.weights[i], rule.weights[n - 1 - i], 1e-14);
      previous = rule.nodes[i];
      sum += rule.weights[i];
    }
    EXPECT_NEAR(sum, 1, 1e-14);
  }
}

TEST(QuadratureTest, RefusesAnEmptyRule) {
  EXPECT_THROW((void)GaussLegendre(0), base::CheckFailure);
}

}  // namespace
}  // namespace mane::math
