// Properties of hulls:
//   coordinates   points and polar angles are each other's inverse; the gradient is E's slope
//   fit           recovers an ellipsoid, encloses a head that is none, refuses what has none

#include "beam/hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "beam/test_random.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using fixtures::Random;

TEST(HullTest, PolarAnglesAndPointsAreInverse) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Hull hull = random.AnyHull();
    const double zenith = random.Uniform(0.01, 3.1), azimuth = random.Uniform(-3.1, 3.1);
    const Vector3d point = hull.Point(zenith, azimuth);
    EXPECT_NEAR(hull.At(point), 0, 1e-13);
    const Polar polar = PolarOf(hull, hull.center + 1.7 * (point - hull.center));
    EXPECT_NEAR(polar.zenith, zenith, 1e-12);
    EXPECT_NEAR(polar.azimuth, azimuth, 1e-12);
  }
  const Hull head{Vector3d(1, 2, 3), Vector3d(0.08, 0.11, 0.1)};
  EXPECT_LT((head.Point(0, 1) - Vector3d(1, 2.11, 3)).norm(), 1e-15);
  EXPECT_LT((head.Point(std::numbers::pi / 2, 0) - Vector3d(1, 2, 3.1)).norm(), 1e-15);
  EXPECT_LT((head.Point(std::numbers::pi / 2, std::numbers::pi / 2) - Vector3d(1.08, 2, 3)).norm(),
            1e-15);
  EXPECT_EQ(PolarOf(head, {1, 3, 3}).azimuth, 0);
}

TEST(HullTest, TheGradientIsTheSlope) {
  Random random(2);
  for (int trial = 0; trial < 100; ++trial) {
    const Hull hull = random.AnyHull();
    const Vector3d point = hull.center + 2 * hull.radii.cwiseProduct(random.Vector(1));
    const double h = 1e-6 * hull.radii.minCoeff();
    for (int j = 0; j < 3; ++j) {
      const Vector3d step = h * Vector3d::Unit(j);
      const double slope = (hull.At(point + step) - hull.At(point - step)) / (2 * h);
      EXPECT_NEAR(hull.Gradient(point)[j], slope, 1e-6 / hull.radii.minCoeff());
    }
  }
}

TEST(FitHullTest, RecoversAnEllipsoid) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Hull hull = random.AnyHull();
    std::vector<Vector3f> points;
    for (int i = 0; i < 500; ++i) {  // Of the upper part, as a scalp is.
      points.emplace_back(
          hull.Point(random.Uniform(0, 2), random.Uniform(-3.14, 3.14)).cast<float>());
    }
    const auto fit = FitHull(points);
    ASSERT_TRUE(fit) << fit.error().message;
    // Coordinates are rounded to float.
    const double tolerance = 1e-6 * (hull.center.norm() + hull.radii.maxCoeff());
    EXPECT_LT((fit->center - hull.center).norm(), tolerance);
    EXPECT_LT((fit->radii - hull.radii).norm(), tolerance);
  }
}

// A head with a nose, ears and a flat back.
std::vector<Vector3f> Mannequin() {
  std::vector<Vector3f> points;
  const Hull skull{Vector3d(0, 0.1, 0.01), Vector3d(0.075, 0.11, 0.095)};
  for (int i = 0; i < 3000; ++i) {
    const double zenith = std::acos(1 - 2 * (i + 0.5) / 3000), azimuth = std::fmod(2.4 * i, 6.28);
    Vector3d p = skull.Point(zenith, azimuth);
    p.z() = std::max(p.z(), -0.07);
    if (std::abs(p.x()) < 0.01 && std::abs(p.y() - 0.08) < 0.02 && p.z() > 0) p.z() += 0.02;
    if (std::abs(p.z()) < 0.01 && std::abs(p.y() - 0.09) < 0.02) p.x() *= 1.15;
    points.emplace_back(p.cast<float>());
  }
  return points;
}

TEST(FitHullTest, EnclosesAHead) {
  const auto points = Mannequin();
  const auto fit = FitHull(points);
  ASSERT_TRUE(fit);
  double farthest = -1;
  for (const Vector3f& p : points) farthest = std::max(farthest, fit->At(p.cast<double>()));
  EXPECT_LE(farthest, 0);
  EXPECT_GT(farthest, -1e-6);  // As little as that takes.
  EXPECT_LT(fit->radii.maxCoeff(), 0.15);
}

TEST(FitHullTest, RefusesWhatHasNoEllipsoid) {
  const auto refused = [](const std::vector<Vector3f>& points) {
    const auto fit = FitHull(points);
    if (fit) return false;
    EXPECT_EQ(fit.error().code, ErrorCode::kInvalidArgument);
    EXPECT_TRUE(fit.error().field.empty());
    return true;
  };
  Random random(4);
  std::vector<Vector3f> plane, tilted, saddle, two_sheets, few, broken = Mannequin();
  for (int i = 0; i < 200; ++i) {
    const float x = static_cast<float>(random.Uniform(-1, 1));
    const float y = static_cast<float>(random.Uniform(-1, 1));
    plane.emplace_back(x, 1, y);
    tilted.emplace_back(x, y, 0.3F * x - 0.7F * y + 2);
    saddle.emplace_back(x, x * x - y * y, y);
    two_sheets.emplace_back(x, (i % 2 == 0 ? 1 : -1) * std::sqrt(0.1F + x * x + y * y), y);
    if (i < 5) few.emplace_back(x, y, x * y);
  }
  broken[7].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(refused(plane));
  EXPECT_TRUE(refused(tilted));
  EXPECT_TRUE(refused(saddle));
  EXPECT_TRUE(refused(two_sheets));
  EXPECT_TRUE(refused(few));
  EXPECT_TRUE(refused({}));
  EXPECT_TRUE(refused(broken));
  EXPECT_TRUE(refused(std::vector<Vector3f>(100, Vector3f(1, 2, 3))));
}

}  // namespace
}  // namespace mane::beam
