// Roots, on meshes and ellipsoids:
//   exact       as many masters and members as asked for, all on the scalp
//   ownership   every member is nearest to its own master, by brute force
//   density     counts over parts of the scalp follow the density's integral (chi-square): two
//               halves, a gradient, an image; nothing grows where it is 0; its scale is nothing
//   evenness    masters keep their distance, in the part where hair grows too
//   bits        the same for any number of workers; another seed, other roots
//   hostile     density 0 everywhere, or next to everywhere, is an error and ends soon

#include "styling/roots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "groom/blue_noise.h"
#include "groom/sampler.h"
#include "math/random.h"
#include "styling/map.h"
#include "styling/nearest.h"
#include "styling/test_scalps.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using std::numbers::pi;

const groom::Scalp kDome = Dome({0.01, 0.02, 0.03}, 1.7, 12);
const groom::Scalp kHead = Head();

Roots Place(const groom::Scalp& scalp, const ScalpMap& density, int wisps, int strands,
            uint64_t seed = 1, int workers = 1) {
  exec::WorkerPool pool(workers);
  Result<Roots> roots = PlaceRoots(scalp, ScalpChart(scalp), density, wisps, strands, seed, pool);
  EXPECT_TRUE(roots) << roots.error().message;
  return *std::move(roots);
}

ScalpMap Painted(int width, int height, std::vector<float> values) {
  ScalpMap map;
  map.image = std::make_shared<MapImage>(MapImage{width, height, std::move(values)});
  return map;
}

// Expects counts of members in `bins` parts of the scalp in proportion to the integral of `density`
// over them, which is taken from evenly drawn points: `bin_of` tells the part of given angles.
template <typename BinOf>
void ExpectProportional(const groom::Scalp& scalp, const ScalpMap& density, int bins,
                        const BinOf& bin_of) {
  constexpr int kStrands = 40000, kPoints = 800000;
  const ScalpChart chart(scalp);
  const groom::HairRegion region(scalp);
  std::vector<double> share(bins, 0), count(bins, 0);
  math::RandomStream random(77, 0);
  double total = 0;
  for (int i = 0; i < kPoints; ++i) {
    const Angles angles = chart.At(region.Draw(random).position);
    const double value = ValueAt(density, angles);
    share[bin_of(angles)] += value;
    total += value;
  }
  for (const Vector3f& x : Place(scalp, density, 50, kStrands).members) {
    count[bin_of(chart.At(x.cast<double>()))] += 1;
  }
  double chi_square = 0;
  int degrees = -1;
  for (int k = 0; k < bins; ++k) {
    const double expected = kStrands * share[k] / total;
    if (share[k] == 0) {
      EXPECT_EQ(count[k], 0);
      continue;
    }
    chi_square += (count[k] - expected) * (count[k] - expected) / expected;
    ++degrees;
  }
  // Mean `degrees`, deviation sqrt(2 degrees); 4.5 of them. The integral's own error is that of a
  // twenty times as many points: a twentieth of it.
  EXPECT_LT(chi_square, 1.05 * (degrees + 4.5 * std::sqrt(2.0 * degrees)));
}

int SectorOf(const Angles& angles) {
  return std::min(int((angles.azimuth + pi) / (2 * pi) * 8), 7) +
         8 * std::min(int(angles.polar / 0.5), 4);
}

TEST(RootsTest, CountsAreExact) {
  for (const groom::Scalp& scalp : {kDome, kHead}) {
    for (const auto& [wisps, strands] : {std::pair(1, 0), {1, 9}, {300, 10}, {40, 5000}}) {
      const Roots roots = Place(scalp, {}, wisps, strands);
      EXPECT_EQ(roots.wisps(), wisps);
      EXPECT_EQ(roots.strands(), strands);
      ASSERT_EQ(roots.first_member.size(), size_t(wisps) + 1);
      EXPECT_EQ(roots.first_member.front(), 0u);
      EXPECT_EQ(roots.first_member.back(), uint32_t(strands));
      EXPECT_TRUE(std::ranges::is_sorted(roots.first_member));
    }
  }
}

TEST(RootsTest, MembersGrowOnTheScalp) {
  const auto& head = std::get<groom::Ellipsoid>(kHead);
  const Vector3d axis = head.cap_axis.normalized();
  for (const Vector3f& member : Place(kHead, {}, 20, 4000).members) {
    const Vector3d x = (member.cast<double>() - head.center).cwiseQuotient(head.radii);
    EXPECT_NEAR(x.norm(), 1, 2e-7);  // Coordinates round to 4e-9 m, of radii of 0.08 m.
    const double cosine = x.cwiseQuotient(head.radii).normalized().dot(axis);
    EXPECT_LE(std::acos(cosine), head.cap_angle + 1e-6);
  }
  const auto& dome = std::get<groom::TriangleMesh>(kDome);
  for (const Vector3f& member : Place(kDome, {}, 20, 300).members) {
    double nearest = 1;
    for (const auto& triangle : dome.triangles) {
      const Vector3d a = dome.vertices[triangle[0]].cast<double>(),
                     b = dome.vertices[triangle[1]].cast<double>(),
                     c = dome.vertices[triangle[2]].cast<double>(), p = member.cast<double>();
      const Vector3d n = (b - a).cross(c - a);
      // Inside in projection: barycentric coordinates.
      const double u = (b - a).cross(p - a).dot(n), v = (c - b).cross(p - b).dot(n),
                   w = (a - c).cross(p - c).dot(n);
      if (std::min({u, v, w}) < -1e-5 * n.squaredNorm()) continue;
      nearest = std::min(nearest, std::abs((p - a).dot(n.normalized())));
    }
    EXPECT_LT(nearest, 2e-8);
  }
}

TEST(RootsTest, MastersLieOnTheirTriangles) {
  const auto& dome = std::get<groom::TriangleMesh>(kDome);
  for (const groom::ScalpPoint& master : Place(kDome, {}, 200, 0).masters) {
    const Vector3d corner = dome.vertices[dome.triangles[master.triangle][0]].cast<double>();
    EXPECT_NEAR((master.position - corner).dot(master.normal), 0, 2e-8);
    EXPECT_NEAR(master.normal.norm(), 1, 1e-12);
  }
}

TEST(RootsTest, MembersBelongToTheNearestMaster) {
  const ScalpMap density{1, {{0, 1}, {1.7, 0.1}}, {}, nullptr};
  for (const groom::Scalp& scalp : {kDome, kHead}) {
    const Roots roots = Place(scalp, density, 150, 6000);
    for (int wisp = 0; wisp < roots.wisps(); ++wisp) {
      for (uint32_t i = roots.first_member[wisp]; i < roots.first_member[wisp + 1]; ++i) {
        double own = 0, nearest = std::numeric_limits<double>::infinity();
        for (int w = 0; w < roots.wisps(); ++w) {
          const double distance =
              (roots.members[i].cast<double>() - roots.masters[w].position).norm();
          if (w == wisp) own = distance;
          nearest = std::min(nearest, distance);
        }
        ASSERT_EQ(own, nearest);
      }
    }
  }
}

TEST(RootsTest, NearestPointsAreThoseOfBruteForce) {
  math::RandomStream random(5, 0);
  for (const int n : {1, 2, 8, 9, 17, 18, 500}) {
    std::vector<Vector3d> points(n);
    for (Vector3d& p : points) {  // On a coarse lattice: many are equally near, some the same.
      for (double& c : p) c = std::floor(random.Uniform(0, 6));
    }
    const NearestPoint nearest(points);
    for (int i = 0; i < 500; ++i) {
      Vector3d x;
      for (double& c : x) c = 0.5 * std::floor(random.Uniform(-2, 14));
      int expected = 0;
      for (int k = 1; k < n; ++k) {
        if ((points[k] - x).squaredNorm() < (points[expected] - x).squaredNorm()) expected = k;
      }
      ASSERT_EQ(nearest.Find(x), expected);
    }
  }
}

TEST(RootsTest, UniformDensityIsUniformOverTheArea) {
  ExpectProportional(kDome, {}, 40, SectorOf);
  ExpectProportional(kHead, {}, 40, SectorOf);
}

TEST(RootsTest, TwoHalvesFollowTheirDensities) {
  // 1 at the left, 1/4 at the right, within a hundredth of a radian.
  const ScalpMap halves{1, {}, {{-3.13, 0.25}, {-0.01, 0.25}, {0, 1}, {3.13, 1}}, nullptr};
  ExpectProportional(kDome, halves, 40, SectorOf);
  ExpectProportional(kHead, halves, 40, SectorOf);
}

TEST(RootsTest, AGradientIsFollowed) {
  ExpectProportional(kDome, {3, {{0, 0}, {1.7, 1}}, {}, nullptr}, 40, SectorOf);
  ExpectProportional(kHead, {3, {{0, 1}, {1, 0}}, {{-2, 1}, {1, 0.1}}, nullptr}, 40, SectorOf);
}

TEST(RootsTest, AnImageIsFollowed) {
  std::vector<float> values(90 * 70);
  math::RandomStream random(3, 0);
  for (float& value : values) value = random.Uniform() < 0.3 ? float(random.Uniform()) : 0.0f;
  for (const groom::Scalp& scalp : {kDome, kHead}) {
    ExpectProportional(scalp, Painted(90, 70, values), 40, SectorOf);
  }
}

TEST(RootsTest, NothingGrowsWhereDensityIsZero) {
  std::vector<float> values(64 * 64, 0);
  for (int y = 30; y < 40; ++y) {
    for (int x = 20; x < 50; ++x) values[y * 64 + x] = 0.5f;
  }
  const ScalpMap patch = Painted(64, 64, values);
  for (const groom::Scalp& scalp : {kDome, kHead}) {
    const ScalpChart chart(scalp);
    const Roots roots = Place(scalp, patch, 300, 20000);
    for (const groom::ScalpPoint& master : roots.masters) {
      EXPECT_GT(ValueAt(patch, chart.At(master.position)), 0);
    }
    for (const Vector3f& member : roots.members) {
      EXPECT_GT(ValueAt(patch, chart.At(member.cast<double>())), 0);
    }
  }
}

double SmallestDistance(const Roots& roots) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < roots.wisps(); ++i) {
    for (int j = 0; j < i; ++j) {
      smallest = std::min(smallest, (roots.masters[i].position - roots.masters[j].position).norm());
    }
  }
  return smallest;
}

TEST(RootsTest, MastersKeepTheirDistance) {
  for (const groom::Scalp& scalp : {kDome, kHead}) {
    for (const int wisps : {30, 400, 1500}) {
      EXPECT_GT(SmallestDistance(Place(scalp, {}, wisps, 0)),
                0.6 * groom::HexagonalDistance(groom::HairArea(scalp), wisps));
    }
  }
}

TEST(RootsTest, MastersKeepTheirDistanceWhereHairGrows) {
  // Hair at the front quarter, of very uneven density; area of a zone of a sphere.
  const ScalpMap quarter{1,
                         {{0, 0.01}, {1.7, 1}},
                         {{-pi / 4 - 1e-9, 0}, {-pi / 4, 1}, {pi / 4, 1}, {pi / 4 + 1e-9, 0}},
                         nullptr};
  const double area = groom::HairArea(kDome) / 4;
  EXPECT_GT(SmallestDistance(Place(kDome, quarter, 300, 0)),
            0.6 * groom::HexagonalDistance(area, 300));
}

TEST(RootsTest, ScaleOfDensityDoesNotCount) {
  const ScalpMap one{1, {{0, 0.5}, {1.7, 1}}, {}, nullptr};
  ScalpMap large = one;
  large.value = 1024;
  EXPECT_EQ(Place(kDome, one, 30, 500).members, Place(kDome, large, 30, 500).members);
}

TEST(RootsTest, AnyNumberOfWorkersMakesTheSameBits) {
  const ScalpMap density{1, {{0, 0}, {1.7, 1}}, {}, nullptr};
  for (const groom::Scalp& scalp : {kDome, kHead}) {
    const Roots one = Place(scalp, density, 100, 10000, 4, 1);
    const Roots four = Place(scalp, density, 100, 10000, 4, 4);
    EXPECT_EQ(one.first_member, four.first_member);
    EXPECT_EQ(one.members, four.members);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(one.masters[i].position, four.masters[i].position);
    const Roots other = Place(scalp, density, 100, 10000, 5, 1);
    EXPECT_NE(one.members[0], other.members[0]);
    EXPECT_NE(one.masters[0].position, other.masters[0].position);
  }
}

// More members of the same seed leave the others and the masters where they are.
TEST(RootsTest, MoreMembersLeaveTheOthersWhereTheyAre) {
  const Roots few = Place(kDome, {}, 1, 100), many = Place(kDome, {}, 1, 200);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(few.members[i], many.members[i]);
  EXPECT_EQ(few.masters[0].position, many.masters[0].position);
}

void ExpectDensityError(const groom::Scalp& scalp, const ScalpMap& density) {
  exec::WorkerPool pool(1);
  const Result<Roots> roots = PlaceRoots(scalp, ScalpChart(scalp), density, 10, 1000, 1, pool);
  ASSERT_FALSE(roots);
  EXPECT_EQ(roots.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(roots.error().field, "density");
}

TEST(RootsTest, NoDensityAnywhereIsAnError) {
  ScalpMap zero;
  zero.value = 0;
  for (const groom::Scalp& scalp : {kDome, kHead}) {
    ExpectDensityError(scalp, zero);
    ExpectDensityError(scalp, Painted(16, 16, std::vector<float>(256, 0)));
    // Hair below the hair region only.
    ExpectDensityError(scalp, {1, {{2.5, 0}, {3, 1}}, {}, nullptr});
    // A ring a billionth wide, on a scalp that has next to no hair besides.
    ExpectDensityError(scalp, {1, {{0.5, 0}, {0.5 + 1e-9, 1}, {0.5 + 2e-9, 0}}, {}, nullptr});
  }
}

TEST(RootsTest, ASinglePixelIsEnough) {
  std::vector<float> values(1024 * 1024, 0);
  values[520 * 1024 + 530] = 1;
  const ScalpMap pixel = Painted(1024, 1024, values);
  for (const groom::Scalp& scalp : {kDome, kHead}) {
    EXPECT_EQ(Place(scalp, pixel, 50, 5000).strands(), 5000);
  }
}

}  // namespace
}  // namespace mane::styling
