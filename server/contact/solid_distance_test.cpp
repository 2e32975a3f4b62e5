// The exact distance to a mesh's solid:
//   nearest point  that of brute force over all triangles, itself checked by sampling triangles
//   sign           that of analytic solids: ball, box, torus (its hole included)
//   winding        an integer, near a surface and far from it
//   several        components nested, overlapping, with a cavity: the union, without buried parts

#include "contact/solid_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "contact/repair.h"
#include "contact/test_meshes.h"
#include "contact/triangle.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class SolidDistanceTest : public ::testing::Test {
 protected:
  static SolidMesh Mend(const TriangleMesh& mesh) {
    MeshReport report;
    auto solid = Repair(mesh, {}, &report);
    EXPECT_TRUE(solid);
    return *solid;
  }
  Vector3d Point(double reach) { return reach * Vector3d(sym_(rng_), sym_(rng_), sym_(rng_)); }

  exec::WorkerPool pool_{2};
  std::mt19937_64 rng_{20240120};
  std::uniform_real_distribution<double> sym_{-1, 1};
};

TEST_F(SolidDistanceTest, NearestPointOfATriangleIsNoFartherThanAnyOther) {
  for (int i = 0; i < 300; ++i) {
    const Vector3d a = Point(1), b = Point(1);
    const Vector3d c = i % 3 == 0 ? Vector3d(a + 1e-9 * Point(1)) : i % 3 == 1 ? b : Point(1);
    const Vector3d p = Point(2);
    const Vector3d found = ClosestOnTriangle(p, PreparedTriangle(a, b, c));
    double least = kInfinity;
    constexpr int kSteps = 40;
    for (int j = 0; j <= kSteps; ++j) {
      for (int k = 0; k <= kSteps - j; ++k) {
        const double u = 1. * j / kSteps, v = 1. * k / kSteps;
        least = std::min(least, (u * a + v * b + (1 - u - v) * c - p).norm());
      }
    }
    EXPECT_LE((found - p).norm(), least + 1e-9);
    EXPECT_GE((found - p).norm(), least - 0.1);  // And it is on the triangle:
    const Vector3d on = ClosestOnTriangle(found, PreparedTriangle(a, b, c));
    EXPECT_LT((on - found).norm(), 1e-12);
  }
}

TEST_F(SolidDistanceTest, NearestPointsAreThoseOfBruteForce) {
  const SolidMesh solid = Mend(fixtures::Torus(0.2, 0.07, 40, 20));
  const ClosestTriangles closest(solid);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = Point(i % 2 ? 0.3 : 3);
    double least = kInfinity;
    for (const auto& [a, b, c] : solid.triangles) {
      const PreparedTriangle t(solid.vertices[a], solid.vertices[b], solid.vertices[c]);
      least = std::min(least, (ClosestOnTriangle(p, t) - p).norm());
    }
    const auto hit = closest.Find(p, kInfinity);
    EXPECT_EQ(hit.distance, least);
    EXPECT_NEAR((hit.point - p).norm(), least, 1e-15);
    // Bounds that hold, exactly too, change nothing; those that do not are made good.
    for (const double within : {1.5 * least, least, 0.3 * least}) {
      const auto again = closest.Find(p, within);
      EXPECT_EQ(again.distance, hit.distance);
      EXPECT_EQ(again.triangle, hit.triangle);
    }
  }
}

TEST_F(SolidDistanceTest, WindingNumbersAreIntegers) {
  const SolidMesh solid = Mend(fixtures::Torus(0.2, 0.07, 60, 30));
  const WindingTree winding(solid);
  double worst = 0;
  for (int i = 0; i < 5000; ++i) {
    const double number = winding.Number(Point(i % 2 ? 0.3 : 2));
    worst = std::max(worst, std::abs(number - std::round(number)));
  }
  EXPECT_LT(worst, 0.1);
}

TEST_F(SolidDistanceTest, SignsAreThoseOfAnalyticSolids) {
  const SolidDistance ball(Mend(fixtures::Sphere(4, 0.1)), &pool_);
  const SolidDistance torus(Mend(fixtures::Torus(0.2, 0.07, 120, 60)), &pool_);
  const SolidDistance box(Mend(fixtures::Box({-0.1, -0.2, -0.3}, {0.1, 0.2, 0.3})), &pool_);
  for (int i = 0; i < 3000; ++i) {
    const Vector3d p = Point(0.35);
    const double to_ball = p.norm() - 0.1;
    const double to_torus = std::hypot(std::hypot(p.x(), p.z()) - 0.2, p.y()) - 0.07;
    const Vector3d q = p.cwiseAbs() - Vector3d(0.1, 0.2, 0.3);
    const double to_box = q.cwiseMax(0).norm() + std::min(0.0, q.maxCoeff());
    EXPECT_NEAR(ball.At(p).distance, to_ball, 2.5e-4);
    EXPECT_NEAR(torus.At(p).distance, to_torus, 5e-4);
    EXPECT_NEAR(box.At(p).distance, to_box, 1e-7);
  }
  EXPECT_GT(torus.At(Vector3d::Zero()).distance, 0.12);  // The hole.
}

TEST_F(SolidDistanceTest, NormalsPointOut) {
  const SolidDistance ball(Mend(fixtures::Sphere(4, 0.1)), &pool_);
  for (int i = 0; i < 500; ++i) {
    const Vector3d p = Point(0.2);
    EXPECT_GT(ball.At(p).normal.dot(p.normalized()), 0.97);
  }
  const Vector3d corner = ball.surface().vertices[3];
  EXPECT_GT(ball.At(corner).normal.dot(corner.normalized()), 0.97);
}

TEST_F(SolidDistanceTest, NestedComponentsAreOneSolid) {
  const auto both = fixtures::Together(fixtures::Sphere(3, 0.2), fixtures::Sphere(2, 0.1));
  const SolidDistance nested(Mend(both), &pool_);
  EXPECT_EQ(nested.buried(), 320);
  EXPECT_NEAR(nested.At({0.1, 0, 0}).distance, -0.1, 2e-3);
  EXPECT_NEAR(nested.At({0, 0, 0}).distance, -0.2, 3e-3);
}

TEST_F(SolidDistanceTest, AnInnerComponentThatFacesInwardsIsACavity) {
  const auto both =
      fixtures::Together(fixtures::Sphere(3, 0.2), fixtures::Inverted(fixtures::Sphere(3, 0.1)));
  const SolidDistance hollow(Mend(both), &pool_);
  EXPECT_EQ(hollow.buried(), 0);
  EXPECT_NEAR(hollow.At({0.02, 0, 0}).distance, 0.08, 2e-3);
  EXPECT_LT(hollow.At({0.02, 0, 0}).normal.x(), -0.9);
  EXPECT_NEAR(hollow.At({0.15, 0, 0}).distance, -0.05, 2e-3);
}

TEST_F(SolidDistanceTest, OverlappingComponentsAreTheirUnion) {
  const Vector3d left(-0.06, 0, 0), right(0.06, 0, 0);
  const SolidDistance both(
      Mend(fixtures::Together(fixtures::Sphere(4, 0.1, left), fixtures::Sphere(4, 0.1, right))),
      &pool_);
  EXPECT_GT(both.buried(), 500);
  for (int i = 0; i < 3000; ++i) {
    const Vector3d p = Point(0.2);
    const double exact = std::min((p - left).norm(), (p - right).norm()) - 0.1;
    if (std::abs(exact) < 3e-4) continue;
    EXPECT_EQ(both.At(p).distance < 0, exact < 0) << p.transpose();
    if (exact > 0) {
      EXPECT_NEAR(both.At(p).distance, exact, 3e-4);
    }
  }
  // In the middle, the nearest surface is where the two meet: 0.08 away.
  EXPECT_NEAR(both.At(Vector3d::Zero()).distance, -0.08, 8e-3);  // Triangles are cut by none.
}

}  // namespace
}  // namespace mane::contact
