// Degenerate and random polylines give finite fits and honest distances.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rod/fit.h"
#include "rod/test_curves.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::kL;
using fixtures::Length;
using fixtures::Points;
using fixtures::Random;
using fixtures::Sample;

void ExpectFinite(const Fit& fit) {
  EXPECT_TRUE(std::isfinite(fit.largest_distance) && std::isfinite(fit.rms_distance));
  EXPECT_TRUE(fit.root.p.allFinite() && fit.root.q.coeffs().allFinite());
  EXPECT_NEAR(fit.root.q.norm(), 1, 1e-12);
  for (const Vector3d& theta : fit.theta) EXPECT_TRUE(theta.allFinite());
  for (const double l : fit.length) EXPECT_TRUE(std::isfinite(l) && l > 0);
  EXPECT_LE(fit.rms_distance, fit.largest_distance * (1 + 1e-12));
}

TEST(FitInputTest, DegenerateInputGivesFiniteAnswers) {
  const Vector3d a(1, 2, 3), b(1, 2.1, 3), c(1.05, 2.1, 3);
  const std::vector<Points> inputs = {{a},
                                      {a, a, a},
                                      {a, b},
                                      {a, a, b, b, b, c, c},
                                      {a, b, a},
                                      {a, b, a, b, a, b},
                                      {a, b, c, a},
                                      {a, b, b + Vector3d(1e-13, 0, 0), c},
                                      {a, a + 1e-9 * c, b},
                                      {a, a + Vector3d(1e-200, 0, 0)},
                                      {1e20 * a, 1e20 * b, 1e20 * c},
                                      {Vector3d::Zero(), 1e-20 * a, 1e-20 * c}};
  for (size_t i = 0; i < inputs.size(); ++i) {
    for (const int N : {1, 5, 20}) {
      SCOPED_TRACE(testing::Message() << i << " " << N);
      const Fit fit = FitPolyline(inputs[i], {.elements = N});
      ExpectFinite(fit);
      EXPECT_EQ(fit.theta.size(), static_cast<size_t>(N));
      EXPECT_EQ(fit.root.p, inputs[i][0]);
      ExpectFinite(FitPolyline(inputs[i], {.elements = N, .bound = 1e-4}));
      ExpectFinite(FitPolyline(inputs[i], {.elements = N, .root = Eigen::Quaterniond(0, 1, 0, 0)}));
    }
  }
  EXPECT_LT(FitPolyline(inputs[3], {.elements = 20}).largest_distance, 1e-3);
}

TEST(FitInputTest, AnyPolylineGivesAFiniteHonestAnswer) {
  Random random(708);
  for (int i = 0; i < 150; ++i) {
    SCOPED_TRACE(i);
    Points points = {random.Vector(1)};
    const int n = 2 + static_cast<int>(random.Uniform(0, 99));
    const double wander = random.Uniform(0, 2);
    Vector3d direction = random.Direction();
    for (int k = 1; k < n; ++k) {
      direction = (direction + wander * random.Vector(1)).normalized();
      points.push_back(points.back() + kL / n * std::pow(10, random.Uniform(-3, 0)) * direction);
    }
    const Fit fit = FitPolyline(points, {.elements = 1 + i % 20});
    ExpectFinite(fit);
    // No point is farther from the centreline than reported.
    const Points fine = Sample(fit, 4001);
    for (const Vector3d& x : points) {
      double nearest = 1e300;
      for (const Vector3d& y : fine) nearest = std::min(nearest, (x - y).norm());
      EXPECT_LE(nearest, fit.largest_distance + Length(fit) / 4000);
    }
  }
}

}  // namespace
}  // namespace mane::rod
