// Properties of section constants:
//   moments    bending stiffnesses and linear density agree with area integrals over the ellipse
//   torsion    agrees with the integral of Prandtl's stress function
//   circle     the textbook values

#include "rod/strand.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mane::rod {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Integral over an ellipse of semi-axes a along x1 and b along x2, in polar form x1 = a r cos t,
// x2 = b r sin t. The midpoint rule is exact in t for low harmonics, and its error in r is
// O(1 / kRadii^2) = 1e-7.
template <typename F>
double OverEllipse(double a, double b, const F& f) {
  constexpr int kRadii = 3000, kAngles = 16;
  double sum = 0;
  for (int i = 0; i < kRadii; ++i) {
    const double r = (i + 0.5) / kRadii;
    for (int j = 0; j < kAngles; ++j) {
      const double t = 2 * kPi * j / kAngles;
      sum += r * f(a * r * std::cos(t), b * r * std::sin(t));
    }
  }
  return sum * a * b * 2 * kPi / kAngles / kRadii;
}

TEST(StrandTest, StiffnessIsTheSecondMomentOfArea) {
  const double a = 61e-6, b = 43e-6;
  const Material material{2e9, 0.4, 1300};
  const Eigen::Vector3d EI = Stiffness({a, b}, material);
  // Bending about n1 stretches in proportion to the distance along n2.
  const double about_1 = 2e9 * OverEllipse(a, b, [](double, double x2) { return x2 * x2; });
  const double about_2 = 2e9 * OverEllipse(a, b, [](double x1, double) { return x1 * x1; });
  EXPECT_NEAR(EI[1] / about_1, 1, 1e-6);
  EXPECT_NEAR(EI[2] / about_2, 1, 1e-6);
  // Prandtl: laplacian phi = -2 and phi = 0 on the boundary; J = 2 int phi dA.
  const double scale = a * a * b * b / (a * a + b * b);
  const double J = 2 * OverEllipse(a, b, [&](double x1, double x2) {
                     return scale * (1 - x1 * x1 / (a * a) - x2 * x2 / (b * b));
                   });
  const double mu = 2e9 / (2 * 1.4);
  EXPECT_NEAR(EI[0] / (mu * J), 1, 1e-6);
  const double area = OverEllipse(a, b, [](double, double) { return 1; });
  EXPECT_NEAR(LinearDensity({a, b}, material) / (1300 * area), 1, 1e-6);
}

TEST(StrandTest, CircularSectionHasTheTextbookValues) {
  const double r = 50e-6, E = 1e9, sigma = 0.48;
  const Eigen::Vector3d EI = Stiffness({r, r}, {E, sigma, 1300});
  const double I = kPi / 4 * std::pow(r, 4);
  EXPECT_NEAR(EI[1] / (E * I), 1, 1e-14);
  EXPECT_NEAR(EI[2] / (E * I), 1, 1e-14);
  EXPECT_NEAR(EI[0] / (E / (2 * (1 + sigma)) * 2 * I), 1, 1e-14);
}

TEST(StrandTest, TotalLengthSumsTheElements) {
  Strand strand;
  strand.length = {0.01, 0.02, 0.07};
  EXPECT_NEAR(strand.TotalLength(), 0.1, 1e-17);
  EXPECT_EQ(strand.elements(), 3);
}

}  // namespace
}  // namespace mane::rod
