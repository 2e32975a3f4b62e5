// First hits of lines: against a search through all triangles of a heap, and where there is none.

#include "contact/first_hit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "contact/test_meshes.h"
#include "math/random.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> InDouble(const TriangleMesh& mesh) {
  std::vector<Vector3d> vertices;
  for (const Eigen::Vector3f& v : mesh.vertices) vertices.emplace_back(v.cast<double>());
  return vertices;
}

// Part of the way to the first triangle, by Cramer's rule for each; infinity for none. `margin` is
// how far inside the triangles' sides, in barycentric coordinates, and inside the way all crossings
// lie at least: near a side rounding decides.
double BruteForce(const std::vector<Vector3d>& vertices, const std::vector<Triangle>& triangles,
                  const Vector3d& from, const Vector3d& to, double* margin) {
  double first = std::numeric_limits<double>::infinity();
  *margin = first;
  for (const auto& [a, b, c] : triangles) {
    Eigen::Matrix3d m;
    m << vertices[b] - vertices[a], vertices[c] - vertices[a], from - to;
    const Vector3d x = m.inverse() * (from - vertices[a]);
    const double inside = std::min({x[0], x[1], 1 - x[0] - x[1], x[2], 1 - x[2]});
    *margin = std::min(*margin, std::abs(inside));
    if (inside > 0) first = std::min(first, x[2]);
  }
  return first;
}

TEST(FirstHit, IsTheFirstOfAllTriangles) {
  const TriangleMesh mesh = fixtures::Heap(200, 0.3);
  const std::vector<Vector3d> vertices = InDouble(mesh);
  const FirstHit hits(vertices, mesh.triangles);
  math::RandomStream random(1, 0);
  const auto point = [&random] {
    return Vector3d(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
  };
  int met = 0, missed = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d from = point(), to = point();
    double margin;
    const double first = BruteForce(vertices, mesh.triangles, from, to, &margin);
    if (margin < 1e-4) continue;
    const auto hit = hits.Find(from, to);
    ASSERT_EQ(hit.has_value(), std::isfinite(first));
    (hit ? met : missed) += 1;
    if (hit) {
      // Float32 of coordinates of some metres.
      EXPECT_LT((*hit - (from + first * (to - from))).norm(), 1e-5);
    }
  }
  EXPECT_GT(met, 100);
  EXPECT_GT(missed, 100);
}

TEST(FirstHit, ComesFromEitherSide) {
  const TriangleMesh mesh = fixtures::Sphere(4, 0.1);
  const FirstHit hits(InDouble(mesh), mesh.triangles);
  const Vector3d out(0.12, 0.16, 0);
  for (const auto& [from, to] : {std::pair(out, Vector3d(0, 0, 0)), {Vector3d(0, 0, 0), out}}) {
    const auto hit = hits.Find(from, to);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->norm(), 0.1, 4e-4);  // Chords of the sphere.
    EXPECT_NEAR(hit->normalized().dot(out.normalized()), 1, 1e-9);
  }
  EXPECT_FALSE(hits.Find(out, 0.6 * out));  // Ends before the sphere.
}

}  // namespace
}  // namespace mane::contact
