// Properties of the blue-noise sampler, on meshes of even and of very uneven triangles and on
// ellipsoids:
//   count     exactly n points, for any n, all on the hair region with the outward normal
//   spacing   the smallest distance is above 0.6 of the hexagonal packing's, which random points
//             miss by far
//   evenness  counts in cells of equal area vary much less than a Poisson process's
//   area      HairArea agrees with closed forms, and zones get points in proportion to their area
//   seed      the same seed gives the same bits, another one other points

#include "groom/sampler.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "groom/blue_noise.h"
#include "math/random.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// The unit square in the plane y = 0, seen from above, of k x k quads. Their widths grow as a power
// of the index: 1 for even ones.
TriangleMesh Square(int k, double power) {
  TriangleMesh mesh;
  for (int i = 0; i <= k; ++i) {
    for (int j = 0; j <= k; ++j) {
      mesh.vertices.emplace_back(std::pow(double(i) / k, power), 0, std::pow(double(j) / k, power));
    }
  }
  for (uint32_t i = 0; i < uint32_t(k); ++i) {
    for (uint32_t j = 0; j < uint32_t(k); ++j) {
      const uint32_t a = i * (k + 1) + j, b = a + k + 1;
      mesh.triangles.push_back({a, a + 1, b});
      mesh.triangles.push_back({b, a + 1, b + 1});
    }
  }
  return mesh;
}

Ellipsoid Head() { return {{0.01, 0.02, -0.03}, {0.078, 0.11, 0.098}, {0.1, 1, -0.2}, 1.3}; }

std::vector<Scalp> Scalps() {
  return {Square(8, 1), Square(12, 3), Head(), Ellipsoid{{0, 0, 0}, {0.1, 0.1, 0.1}}};
}

double SmallestDistance(const std::vector<ScalpPoint>& points) {
  double smallest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      smallest = std::min(smallest, (points[i].position - points[j].position).norm());
    }
  }
  return smallest;
}

TEST(SamplerTest, GivesExactlyNPointsForAnyN) {
  for (const Scalp& scalp : Scalps()) {
    for (const int n : {1, 2, 3, 7, 50, 333, 1000}) {
      EXPECT_EQ(SampleScalp(scalp, n, 5).size(), size_t(n));
    }
  }
}

TEST(SamplerTest, MeshPointsLieInTheirHairTriangle) {
  TriangleMesh mesh = Square(10, 2);
  for (uint32_t t = 0; t < mesh.triangles.size(); t += 3) mesh.hair_triangles.push_back(t);
  for (const ScalpPoint& point : SampleScalp(mesh, 500, 11)) {
    ASSERT_EQ(point.triangle % 3, 0);
    const auto& [ia, ib, ic] = mesh.triangles[point.triangle];
    const Vector3d a = mesh.vertices[ia].cast<double>(), b = mesh.vertices[ib].cast<double>(),
                   c = mesh.vertices[ic].cast<double>(), p = point.position;
    // Barycentric coordinates: signed areas, all inside and adding up.
    const Vector3d n = (b - a).cross(c - a);
    EXPECT_GE((b - a).cross(p - a).dot(n), -1e-12 * n.squaredNorm());
    EXPECT_GE((c - b).cross(p - b).dot(n), -1e-12 * n.squaredNorm());
    EXPECT_GE((a - c).cross(p - c).dot(n), -1e-12 * n.squaredNorm());
    EXPECT_NEAR(p.y(), 0, 1e-15);
    EXPECT_LT((point.normal - Vector3d::UnitY()).norm(), 1e-12);
  }
}

TEST(SamplerTest, EllipsoidPointsLieInTheCap) {
  for (const double cap_angle : {0.02, 1.3, 2.5, pi}) {
    SCOPED_TRACE(cap_angle);
    Ellipsoid ellipsoid = Head();
    ellipsoid.cap_angle = cap_angle;
    const Vector3d axis = ellipsoid.cap_axis.normalized();
    double widest = 0;
    for (const ScalpPoint& point : SampleScalp(ellipsoid, 400, 3)) {
      const Vector3d x = (point.position - ellipsoid.center).cwiseQuotient(ellipsoid.radii);
      EXPECT_NEAR(x.norm(), 1, 1e-12);
      const Vector3d gradient = x.cwiseQuotient(ellipsoid.radii).normalized();
      EXPECT_LT((point.normal - gradient).norm(), 1e-12);
      const double angle = std::atan2(axis.cross(point.normal).norm(), axis.dot(point.normal));
      EXPECT_LE(angle, cap_angle * (1 + 1e-9));
      widest = std::max(widest, angle);
      EXPECT_EQ(point.triangle, -1);
    }
    EXPECT_GT(widest, 0.9 * cap_angle);
  }
}

TEST(SamplerTest, PointsKeepTheirDistance) {
  for (const Scalp& scalp : Scalps()) {
    SCOPED_TRACE(scalp.index());
    for (const int n : {20, 200, 1000}) {
      SCOPED_TRACE(n);
      const double hexagonal = HexagonalDistance(HairArea(scalp), n);
      for (const uint64_t seed : {1, 2, 3}) {
        EXPECT_GT(SmallestDistance(SampleScalp(scalp, n, seed)), 0.6 * hexagonal);
      }
    }
  }
}

TEST(SamplerTest, RandomPointsWouldNotKeepTheirDistance) {
  math::RandomStream random(7, 0);
  std::vector<ScalpPoint> points(1000);
  for (ScalpPoint& p : points) p.position = {random.Uniform(), 0, random.Uniform()};
  EXPECT_LT(SmallestDistance(points), 0.1 * HexagonalDistance(1, 1000));
}

TEST(SamplerTest, CountsInEqualCellsVaryFarLessThanPoisson) {
  for (const double power : {1.0, 3.0}) {
    SCOPED_TRACE(power);
    constexpr int kCells = 10, kPoints = 2000;
    std::vector<int> count(kCells * kCells, 0);
    for (const ScalpPoint& point : SampleScalp(Square(12, power), kPoints, 99)) {
      const int i = std::min(int(point.position.x() * kCells), kCells - 1);
      const int j = std::min(int(point.position.z() * kCells), kCells - 1);
      ++count[i * kCells + j];
    }
    const double mean = double(kPoints) / count.size();
    double variance = 0;
    for (const int c : count) variance += (c - mean) * (c - mean) / count.size();
    EXPECT_LT(variance, 0.25 * mean);  // Poisson: variance = mean.
  }
}

TEST(SamplerTest, AreaIsThatOfClosedForms) {
  EXPECT_NEAR(HairArea(Square(12, 3)), 1, 1e-6);  // Vertices are float32.
  EXPECT_EQ(HairArea(std::monostate()), 0);
  EXPECT_NEAR(HairArea(Ellipsoid{{1, 2, 3}, {2, 2, 2}}), 16 * pi, 1e-9);
  EXPECT_NEAR(HairArea(Ellipsoid{{1, 2, 3}, {2, 2, 2}, {1, 1, 0}, 0.7}),
              8 * pi * (1 - std::cos(0.7)), 1e-9);
  const double a = 1, c = 1.5, e = std::sqrt(1 - a * a / (c * c));  // Prolate spheroid.
  const double prolate = 2 * pi * a * a * (1 + c / (a * e) * std::asin(e));
  EXPECT_NEAR(HairArea(Ellipsoid{{0, 0, 0}, {a, c, a}}) / prolate, 1, 1e-3);
  EXPECT_NEAR(HairArea(Ellipsoid{{0, 0, 0}, {c, a, a}}) / prolate, 1, 1e-3);
}

TEST(SamplerTest, ZonesOfASpheroidGetPointsByTheirArea) {
  constexpr int kZones = 8, kPoints = 4000;
  const double a = 0.5, c = 1;  // Semi-axis c along y; radius at y is a sqrt(1 - y^2 / c^2).
  std::vector<double> area(kZones, 0), count(kZones, 0);
  constexpr int kSlices = 1000;  // Of each zone; midpoint rule of 2 pi rho sqrt(1 + rho'^2) dy.
  double total = 0;
  for (int i = 0; i < kZones * kSlices; ++i) {
    const double y = -c + 2 * c * (i + 0.5) / (kZones * kSlices);
    const double slice =
        std::sqrt(a * a * (1 - y * y / (c * c)) + std::pow(a * a * y / (c * c), 2));
    area[i / kSlices] += slice;
    total += slice;
  }
  for (const ScalpPoint& p : SampleScalp(Ellipsoid{{0, 0, 0}, {a, c, a}}, kPoints, 21)) {
    count[std::min(int((p.position.y() + c) / (2 * c) * kZones), kZones - 1)] += 1;
  }
  for (int zone = 0; zone < kZones; ++zone) {
    EXPECT_NEAR(count[zone] / (kPoints * area[zone] / total), 1, 0.05) << zone;
  }
}

TEST(SamplerTest, SameSeedSameBitsOtherSeedOtherPoints) {
  for (const Scalp& scalp : Scalps()) {
    const auto points = SampleScalp(scalp, 100, 42), again = SampleScalp(scalp, 100, 42),
               other = SampleScalp(scalp, 100, 43);
    int shared = 0;
    for (int i = 0; i < 100; ++i) {
      EXPECT_EQ(points[i].position, again[i].position);
      EXPECT_EQ(points[i].normal, again[i].normal);
      EXPECT_EQ(points[i].triangle, again[i].triangle);
      for (const ScalpPoint& p : other) shared += p.position == points[i].position;
    }
    EXPECT_EQ(shared, 0);
  }
}

TEST(BlueNoiseTest, KeepsAllWhenAllAreAskedFor) {
  const std::vector<Vector3d> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  EXPECT_EQ(EliminateToBlueNoise(points, 4, 1), (std::vector<int>{0, 1, 2, 3}));
}

TEST(BlueNoiseTest, DropsTheCrowdedPointsFirst) {
  // Two coincident points and one close to them, among points far apart.
  const std::vector<Vector3d> points{{0, 0, 0}, {0, 0, 0}, {0.1, 0, 0},
                                     {5, 0, 0}, {0, 5, 0}, {5, 5, 0}};
  const std::vector<int> kept = EliminateToBlueNoise(points, 4, 25);
  EXPECT_EQ(kept.size(), 4u);
  int crowded = 0;
  for (const int i : kept) crowded += i <= 2;
  EXPECT_EQ(crowded, 1);
}

}  // namespace
}  // namespace mane::groom
