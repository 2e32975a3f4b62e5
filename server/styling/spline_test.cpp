// Laws of the Catmull-Rom spline, on random points:
//   interpolation  knot i is control point i
//   smoothness     values and tangents agree from both sides of a knot; the tangent is the
//                  derivative
//   affine         the spline of mapped points is the mapped spline
//   parabola       points of a parabola at equal parameters give it back, ends included

#include "styling/spline.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "math/random.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> RandomPoints(int n, uint64_t seed) {
  math::RandomStream random(seed, 0);
  std::vector<Vector3d> points(n);
  for (Vector3d& p : points) p = {random.Normal(), random.Normal(), random.Normal()};
  return points;
}

TEST(SplineTest, GoesThroughItsPoints) {
  for (int n : {1, 2, 3, 10}) {
    const auto points = RandomPoints(n, 1);
    const Spline<double> spline(points);
    for (int i = 0; i < n; ++i) {
      EXPECT_LT((spline.At(n == 1 ? 0 : static_cast<double>(i) / (n - 1)) - points[i]).norm(),
                1e-14);
    }
  }
}

TEST(SplineTest, FloatPointsMakeTheSameCurve) {
  const auto points = RandomPoints(9, 2);
  std::vector<Eigen::Vector3f> rounded;
  for (const Vector3d& p : points) rounded.emplace_back(p.cast<float>());
  for (double s = 0; s <= 1; s += 0.01) {
    EXPECT_LT((Spline<double>(points).At(s) - Spline<float>(rounded).At(s)).norm(), 1e-6);
  }
}

TEST(SplineTest, IsOnceContinuouslyDifferentiable) {
  const auto points = RandomPoints(8, 3);
  const Spline<double> spline(points);
  const double e = 1e-9;
  for (int i = 1; i < 7; ++i) {
    const double s = i / 7.0;
    EXPECT_LT((spline.At(s - e) - spline.At(s + e)).norm(), 1e-6);
    EXPECT_LT((spline.Tangent(s - e) - spline.Tangent(s + e)).norm(), 1e-5);
  }
  for (double s = 0.01; s < 1; s += 0.0137) {  // Central differences: error of order h^2.
    const double h = 1e-6;
    EXPECT_LT((spline.Tangent(s) - (spline.At(s + h) - spline.At(s - h)) / (2 * h)).norm(), 1e-6);
  }
}

TEST(SplineTest, CommutesWithAffineMaps) {
  const auto points = RandomPoints(7, 4);
  const Eigen::Matrix3d A = Eigen::Matrix3d::Random();
  const Vector3d b(1, -2, 3);
  std::vector<Vector3d> mapped;
  for (const Vector3d& p : points) mapped.emplace_back(A * p + b);
  for (double s = 0; s <= 1; s += 0.0123) {
    EXPECT_LT((Spline<double>(mapped).At(s) - (A * Spline<double>(points).At(s) + b)).norm(),
              1e-13);
  }
}

TEST(SplineTest, ReproducesAParabola) {
  const auto parabola = [](double x) { return Vector3d(x, x * x - 2 * x, 3 * x * x); };
  std::vector<Vector3d> points;
  for (int i = 0; i < 6; ++i) points.push_back(parabola(i));
  for (double s = 0; s <= 1; s += 0.0123) {
    EXPECT_LT((Spline<double>(points).At(s) - parabola(5 * s)).norm(), 1e-13);
  }
}

TEST(ResampleTest, PointsLieAtEqualArcLengthOnTheCurve) {
  // A circle, densely: equal arcs are equal chords, to the square of the polyline's step.
  std::vector<Vector3d> circle;
  for (int i = 0; i <= 5000; ++i) {
    const double x = std::pow(i / 5000.0, 1.5) * 5;  // Uneven on purpose.
    circle.emplace_back(std::cos(x), std::sin(x), 0);
  }
  const auto points = Resample(circle, 12);
  EXPECT_EQ(points.front(), circle.front());
  EXPECT_EQ(points.back(), circle.back());
  for (int i = 0; i + 1 < 12; ++i) {
    EXPECT_NEAR((points[i + 1] - points[i]).norm(), 2 * std::sin(5.0 / 22), 1e-5);
  }
  const auto spline_points = RandomPoints(5, 5);
  const auto dense = Spline<double>(spline_points).Polyline(100);
  EXPECT_EQ(dense.size(), 401U);
  EXPECT_EQ(Resample(dense, 2).back(), spline_points.back());
}

TEST(ResampleTest, OnePlaceStaysOne) {
  const std::vector<Vector3d> points(3, Vector3d(1, 2, 3));
  for (const Vector3d& p : Resample(points, 4)) EXPECT_EQ(p, points[0]);
}

}  // namespace
}  // namespace mane::styling
