// Properties of the distance to an ellipsoid, for radii of a ratio up to 1000:
//   foot         the point at that distance against the normal is on the surface, and the normal is
//                the surface's there
//   brute force  no sampled surface point is nearer; one is hardly farther
//   symmetry     points in planes and on axes of symmetry, the centre included
//   sphere       closed form
//   float32      follows double precision

#include "contact/ellipsoid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace mane::contact {
namespace {

using Eigen::Vector3d;

const Vector3d kRadii[] = {{0.08, 0.11, 0.095}, {1, 1, 1},       {0.1, 0.1, 0.3},  {1, 0.02, 0.3},
                           {0.01, 1, 0.7},      {0.001, 1, 0.5}, {0.5, 0.5, 0.001}};

class EllipsoidTest : public ::testing::Test {
 protected:
  Vector3d Point(const Vector3d& radii, double reach) {
    return reach * Vector3d(sym_(rng_), sym_(rng_), sym_(rng_)).cwiseProduct(radii);
  }
  std::mt19937_64 rng_{20240118};
  std::uniform_real_distribution<double> sym_{-1, 1};
};

// The foot of `point` is on the surface, and the normal is the gradient's direction there.
void ExpectFoot(const Vector3d& radii, const Vector3d& point, double tolerance) {
  const Distance found = Ellipsoid(radii).At(point);
  ASSERT_TRUE(std::isfinite(found.distance));
  EXPECT_NEAR(found.normal.norm(), 1, 1e-12);
  const Vector3d foot = point - found.distance * found.normal;
  const Vector3d gradient = foot.cwiseQuotient(radii.cwiseProduct(radii));
  const double value = foot.cwiseQuotient(radii).squaredNorm() - 1;
  EXPECT_LT(std::abs(value) / (2 * gradient.norm()), tolerance);  // Distance to first order.
  EXPECT_LT((gradient.normalized() - found.normal).norm(), 1e-5);
  const double inside = point.cwiseQuotient(radii).squaredNorm() - 1;
  if (std::abs(inside) > 1e-9) {
    EXPECT_EQ(found.distance < 0, inside < 0);
  }
}

TEST_F(EllipsoidTest, FeetAreOnTheSurfaceAlongItsNormal) {
  for (const Vector3d& radii : kRadii) {
    for (const double reach : {1.0, 1.3, 20.0}) {
      for (int i = 0; i < 300; ++i) {
        const Vector3d point = Point(radii, reach);
        SCOPED_TRACE(testing::Message() << radii.transpose() << " at " << point.transpose());
        ExpectFoot(radii, point, 1e-12 * std::max(1.0, point.norm()));
      }
    }
  }
}

TEST_F(EllipsoidTest, NoSurfacePointIsNearer) {
  for (const Vector3d& radii : kRadii) {
    constexpr int kSteps = 400;
    std::vector<Vector3d> surface;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; j < 2 * kSteps; ++j) {
        const double a = std::numbers::pi * i / kSteps, b = std::numbers::pi * j / kSteps;
        surface.push_back(radii.cwiseProduct(
            Vector3d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a))));
      }
    }
    const double spacing = std::numbers::pi / kSteps * radii.maxCoeff();
    for (int i = 0; i < 10; ++i) {
      const Vector3d point = Point(radii, 1.5);
      double least = std::numeric_limits<double>::infinity();
      for (const Vector3d& s : surface) least = std::min(least, (s - point).norm());
      const double distance = std::abs(Ellipsoid(radii).At(point).distance);
      EXPECT_LE(distance, least + 1e-12) << radii.transpose() << " at " << point.transpose();
      EXPECT_GE(distance, least - spacing);
    }
  }
}

TEST_F(EllipsoidTest, PlanesAndAxesOfSymmetryAreNoExceptions) {
  for (const Vector3d& radii : kRadii) {
    for (int mask = 0; mask < 8; ++mask) {
      for (int i = 0; i < 50; ++i) {
        Vector3d point = Point(radii, 1.1);
        for (int a = 0; a < 3; ++a) point[a] *= mask >> a & 1;
        SCOPED_TRACE(testing::Message() << radii.transpose() << " at " << point.transpose());
        ExpectFoot(radii, point, 1e-11);
      }
    }
    EXPECT_NEAR(Ellipsoid(radii).At(Vector3d::Zero()).distance, -radii.minCoeff(), 1e-12);
  }
}

TEST_F(EllipsoidTest, ASphereIsItsClosedForm) {
  const double r = 0.3;
  for (int i = 0; i < 200; ++i) {
    const Vector3d point = Point(Vector3d::Constant(r), 3);
    const Distance found = Ellipsoid(Vector3d::Constant(r)).At(point);
    EXPECT_NEAR(found.distance, point.norm() - r, 1e-14);
    EXPECT_LT((found.normal - point.normalized()).norm(), 1e-13);
  }
}

TEST_F(EllipsoidTest, Float32FollowsDouble) {
  for (const Vector3d& radii : {kRadii[0], kRadii[1], kRadii[2], kRadii[3], kRadii[4]}) {
    std::vector<float> x, y, z;
    for (int i = 0; i < 5000; ++i) {
      const Vector3d point = Point(radii, i % 2 ? 1.2 : 5);
      x.push_back(static_cast<float>(point.x()));
      y.push_back(static_cast<float>(point.y()));
      z.push_back(static_cast<float>(point.z()));
    }
    std::vector<float> d(x.size()), nx(d), ny(d), nz(d);
    Ellipsoid(radii).At({x, y, z}, {d, nx, ny, nz});
    double worst = 0;
    for (size_t i = 0; i < x.size(); ++i) {
      const Vector3d point(x[i], y[i], z[i]);
      const Distance exact = Ellipsoid(radii).At(point);
      const double scale = std::max(radii.maxCoeff(), point.norm());
      worst = std::max(worst, std::abs(d[i] - exact.distance) / scale);
      EXPECT_NEAR(Vector3d(nx[i], ny[i], nz[i]).norm(), 1, 1e-6);
    }
    EXPECT_LT(worst, 3e-6) << radii.transpose();
  }
}

}  // namespace
}  // namespace mane::contact
