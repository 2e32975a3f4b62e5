// The chart:
//   centre     exact of a cap of a sphere, however small a part of it; bounded where flat or hollow
//   angles     invert DirectionOf; front, left, top and back are where the header says
//   image      inverts FromImage; distances from the middle are polar angles
//   poles      have azimuth 0, whatever the sign of a zero; half a turn is +pi

#include "styling/chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "math/random.h"
#include "styling/test_scalps.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

ScalpChart AtOrigin() { return ScalpChart(groom::Ellipsoid{}); }

TEST(ChartTest, AnEllipsoidsCenterIsItsOwn) {
  EXPECT_EQ(ScalpChart(Head()).center(), Head().center);
}

TEST(ChartTest, ACapsCenterIsItsSpheres) {
  const Vector3d center(0.02, 1.6, -0.01);
  for (const double angle : {0.5, 1.0, 1.8, 2.8, pi}) {
    // Vertices are rounded to 1e-7 m; a cap's sphere magnifies that by 1 / angle^2 or so.
    EXPECT_LT((ScalpChart(Dome(center, angle, 12)).center() - center).norm(), 5e-6) << angle;
  }
}

TEST(ChartTest, OnlyHairTrianglesCount) {
  groom::TriangleMesh mesh = Dome(Vector3d::Zero(), 1.2, 10);
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) mesh.hair_triangles.push_back(t);
  for (const Vector3d& x : {Vector3d(9, 0, 0), Vector3d(9, 1, 0), Vector3d(9, 0, 1)}) {
    mesh.vertices.push_back(x.cast<float>());
  }
  const auto last = static_cast<uint32_t>(mesh.vertices.size());
  mesh.triangles.push_back({last - 3, last - 2, last - 1});
  EXPECT_LT(ScalpChart(mesh).center().norm(), 1e-6);
}

// The mean of a unit square is (1/2, 0, 1/2), its rms radius sqrt(2 / 12).
TEST(ChartTest, AFlatScalpsCenterIsFourRadiiBelow) {
  const Vector3d expected(0.5, -4 * std::sqrt(1.0 / 6), 0.5);
  // The corners of k x k quads have second moments that are too large by 1 / k^2 or so.
  EXPECT_LT((ScalpChart(Square(40)).center() - expected).norm(), 2e-3);
}

TEST(ChartTest, AHollowsCenterIsOnItsInnerSide) {
  groom::TriangleMesh bowl = Dome(Vector3d::Zero(), 0.8, 10);
  for (auto& triangle : bowl.triangles) std::swap(triangle[1], triangle[2]);
  const Vector3d center = ScalpChart(bowl).center();
  EXPECT_GT(center.y(), kDomeRadius);  // Outward is down now.
  EXPECT_LT(center.norm(), 6 * kDomeRadius);
}

TEST(ChartTest, AnglesInvertDirections) {
  const ScalpChart chart(Head());
  math::RandomStream random(1, 0);
  for (int i = 0; i < 10000; ++i) {
    const Angles angles{pi * random.Uniform(0.001, 0.999), pi * random.Uniform(-1, 1)};
    const Angles back = chart.At(chart.center() + random.Uniform(0.01, 1) * DirectionOf(angles));
    EXPECT_NEAR(back.polar, angles.polar, 1e-12);
    EXPECT_NEAR(back.azimuth, angles.azimuth, 1e-10);
    EXPECT_NEAR(DirectionOf(angles).norm(), 1, 1e-15);
  }
}

TEST(ChartTest, ImagesInvert) {
  math::RandomStream random(2, 0);
  for (int i = 0; i < 10000; ++i) {
    const Angles angles{pi * random.Uniform(), pi * random.Uniform(-1, 1)};
    const ImagePoint point = ToImage(angles);
    EXPECT_NEAR(std::hypot(point.u - 0.5, point.v - 0.5), angles.polar / (2 * pi), 1e-15);
    const Angles back = FromImage(point);
    EXPECT_NEAR(back.polar, angles.polar, 1e-14);
    EXPECT_NEAR(back.azimuth, angles.azimuth, 1e-13 / angles.polar);
  }
}

TEST(ChartTest, ForeheadIsAtTheBottomAndLeftAtTheRight) {
  const ScalpChart chart = AtOrigin();
  const auto expect = [&](const Vector3d& x, double polar, double azimuth, double u, double v) {
    const Angles angles = chart.At(x);
    EXPECT_NEAR(angles.polar, polar, 1e-15);
    EXPECT_NEAR(angles.azimuth, azimuth, 1e-15);
    EXPECT_NEAR(ToImage(angles).u, u, 1e-15);
    EXPECT_NEAR(ToImage(angles).v, v, 1e-15);
  };
  expect({0, 0, 1}, pi / 2, 0, 0.5, 0.75);
  expect({1, 0, 0}, pi / 2, pi / 2, 0.75, 0.5);
  expect({-1, 0, 0}, pi / 2, -pi / 2, 0.25, 0.5);
  expect({0, 0, -1}, pi / 2, pi, 0.5, 0.25);
  expect({0, 1, 0}, 0, 0, 0.5, 0.5);
  expect({0, -1, 0}, pi, 0, 0.5, 1);
}

TEST(ChartTest, SignsOfZeroDoNotCount) {
  const ScalpChart chart = AtOrigin();
  for (const double x : {0.0, -0.0}) {
    EXPECT_EQ(chart.At({x, x, -1}).azimuth, pi);  // Never -pi.
    for (const double z : {0.0, -0.0}) {
      EXPECT_EQ(chart.At({x, 1, z}).azimuth, 0);
      EXPECT_EQ(chart.At({x, -1, z}).azimuth, 0);
      EXPECT_EQ(chart.At({x, z, z}).polar, 0);  // The centre itself.
      EXPECT_EQ(chart.At({x, z, z}).azimuth, 0);
    }
  }
  EXPECT_EQ(FromImage({0.5, 0.5}).azimuth, 0);
  EXPECT_EQ(FromImage({0.5, 0.25}).azimuth, pi);
}

TEST(ChartTest, OutsideTheCircleIsTheBottom) {
  const Angles corner = FromImage({1, 1});
  EXPECT_EQ(corner.polar, pi);
  EXPECT_NEAR(corner.azimuth, pi / 4, 1e-15);
}

}  // namespace
}  // namespace mane::styling
