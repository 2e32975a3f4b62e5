// Properties of pores:
//   place    on the hull, in the region, whichever way that goes round; hair along the normal
//   random   as many per area everywhere; the same whatever else is asked for
//   even     exactly as many as asked for, neighbours at like distances
//   tied     on a disc across the direction

#include "beam/pores.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

const Hull kHead{Vector3d(0.02, 0.1, -0.01), Vector3d(0.08, 0.11, 0.1)};

Part PartOf(Part::Spread spread, const PoreRegion& region, int count) {
  Part part;
  part.spread = spread;
  part.pores = region;
  part.count = count;
  return part;
}

TEST(PoresTest, LieOnTheHullInTheRegion) {
  const PoreRegion regions[] = {
      {}, {0.3, 1.2, -0.5, 1}, {0.5, 2, 2.5, -2.5}, {1, 1.1, 3, -3.1}, {0, 0.2, -pi, pi}};
  for (const PoreRegion& region : regions) {
    for (const auto spread : {Part::Spread::kRandom, Part::Spread::kUniform}) {
      for (const int count : {1, 2, 3, 1000}) {
        const Pores pores(kHead, PartOf(spread, region, count), 1, 0);
        for (int i = 0; i < count; ++i) {
          const Pore pore = pores.At(i);
          EXPECT_NEAR(kHead.At(pore.root), 0, 1e-13);
          EXPECT_LE(std::abs(pore.polar.azimuth), pi);
          EXPECT_TRUE(Contains(region, pore.polar))
              << pore.polar.zenith << " " << pore.polar.azimuth;
          EXPECT_NEAR(pore.direction.norm(), 1, 1e-14);
          EXPECT_GT(pore.direction.dot(kHead.Gradient(pore.root).normalized()), 1 - 1e-14);
        }
      }
    }
  }
}

TEST(PoresTest, RegionsGoThroughTheNapeWhereTheyBeginAfterTheyEnd) {
  const PoreRegion nape{0, pi, 2, -2}, face{0, pi, -2, 2};
  EXPECT_TRUE(Contains(nape, {1, 3}));
  EXPECT_TRUE(Contains(nape, {1, -3}));
  EXPECT_FALSE(Contains(nape, {1, 0}));
  EXPECT_FALSE(Contains(face, {1, 3}));
  EXPECT_TRUE(Contains(face, {1, 0}));
  EXPECT_TRUE(Contains(face, {pi, 2}));  // The ends belong to both.
  EXPECT_TRUE(Contains(nape, {0, 2}));
}

// Area of the hull between angles, by small facets.
double AreaOf(const Hull& hull, const PoreRegion& region) {
  const int n = 200;
  const auto point = [&](int i, int j) {
    return hull.Point(std::lerp(region.least_zenith, region.greatest_zenith, 1.0 * i / n),
                      std::lerp(region.from_azimuth, region.to_azimuth, 1.0 * j / n));
  };
  double area = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const Vector3d a = point(i + 1, j + 1) - point(i, j), b = point(i, j + 1) - point(i + 1, j);
      area += 0.5 * Vector3d(a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
                             a.x() * b.y() - a.y() * b.x())
                        .norm();
    }
  }
  return area;
}

// How far the numbers of pores in 6 x 8 cells are from their areas, as chi squared.
double ChiSquared(const Hull& hull, const PoreRegion& region, Part::Spread spread, int count) {
  const Pores pores(hull, PartOf(spread, region, count), 5, 0);
  const double whole = AreaOf(hull, region);
  std::array<int, 48> found{};
  const auto share = [](double value, double from, double to, int cells) {
    return std::clamp(static_cast<int>((value - from) / (to - from) * cells), 0, cells - 1);
  };
  for (int i = 0; i < count; ++i) {
    const Polar pore = pores.At(i).polar;
    ++found[8 * share(pore.zenith, region.least_zenith, region.greatest_zenith, 6) +
            share(pore.azimuth, region.from_azimuth, region.to_azimuth, 8)];
  }
  double sum = 0;
  for (int cell = 0; cell < 48; ++cell) {
    const auto zenith = [&](int i) {
      return std::lerp(region.least_zenith, region.greatest_zenith, i / 6.0);
    };
    const auto azimuth = [&](int i) {
      return std::lerp(region.from_azimuth, region.to_azimuth, i / 8.0);
    };
    const double expected = count / whole *
                            AreaOf(hull, {zenith(cell / 8), zenith(cell / 8 + 1), azimuth(cell % 8),
                                          azimuth(cell % 8 + 1)});
    sum += (found[cell] - expected) * (found[cell] - expected) / expected;
  }
  return sum;
}

TEST(PoresTest, AreDrawnEvenlyOverTheArea) {
  // Of 47 degrees of freedom: above 82.7 with probability 0.001.
  for (const Hull& hull : {kHead, Hull{Vector3d::Zero(), Vector3d(1, 0.2, 0.4)}}) {
    EXPECT_LT(ChiSquared(hull, {}, Part::Spread::kRandom, 100'000), 82.7);
    EXPECT_LT(ChiSquared(hull, {0.2, 1.7, -1, 2}, Part::Spread::kRandom, 100'000), 82.7);
  }
}

TEST(PoresTest, OfEvenSpreadAreAtLikeDistances) {
  const int count = 2000;
  const PoreRegion region{0.3, 1.8, -2, 2};
  const Pores pores(kHead, PartOf(Part::Spread::kUniform, region, count), 1, 0);
  const double distance = std::sqrt(AreaOf(kHead, region) / count);
  std::vector<Vector3d> roots;
  for (int i = 0; i < count; ++i) roots.emplace_back(pores.At(i).root);
  std::vector<double> nearest;
  for (int i = 0; i < count; ++i) {
    double least = 1;
    for (int j = 0; j < count; ++j) {
      if (j != i) least = std::min(least, (roots[i] - roots[j]).norm());
    }
    nearest.emplace_back(least / distance);
  }
  std::ranges::sort(nearest);
  EXPECT_GT(nearest.front(), 0.6);
  EXPECT_LT(nearest.back(), 1.25);
  // No line of first pores runs down the region's edge.
  int first = 0;
  for (int i = 0; i < count; ++i) first += pores.At(i).polar.azimuth < -2 + 1e-9 ? 1 : 0;
  EXPECT_LE(first, 1);
}

TEST(PoresTest, DependOnSeedPartAndHairAlone) {
  const Part part = PartOf(Part::Spread::kRandom, {}, 100);
  Part fewer = part;
  fewer.count = 10;
  const Pores pores(kHead, part, 1, 2), less(kHead, fewer, 1, 2), other_seed(kHead, part, 2, 2),
      other_part(kHead, part, 1, 3);
  for (int i = 9; i >= 0; --i) {
    EXPECT_EQ(pores.At(i).root, less.At(i).root);
    EXPECT_NE(pores.At(i).root, other_seed.At(i).root);
    EXPECT_NE(pores.At(i).root, other_part.At(i).root);
  }
}

TEST(PoresTest, OfTiedHairLieOnADisc) {
  for (const auto spread : {Part::Spread::kRandom, Part::Spread::kUniform}) {
    Part part = PartOf(spread, {}, 500);
    part.tied_at = Vector3d(0, 0.1, -0.2);
    part.tied_along = {0, 2, -3};
    part.tied_radius = 0.02;
    const Pores pores(kHead, part, 1, 0);
    Vector3d middle = Vector3d::Zero();
    int inner = 0;
    for (int i = 0; i < 500; ++i) {
      const Pore pore = pores.At(i);
      const Vector3d off = pore.root - *part.tied_at;
      EXPECT_NEAR(off.dot(part.tied_along), 0, 1e-15);
      EXPECT_LE(off.norm(), 0.02);
      EXPECT_LT((pore.direction - part.tied_along.normalized()).norm(), 1e-15);
      middle += off / 500;
      inner += off.norm() < 0.01 ? 1 : 0;
    }
    EXPECT_LT(middle.norm(), 1e-3);
    EXPECT_NEAR(inner, 125, 30);  // A quarter of the area.
  }
}

}  // namespace
}  // namespace mane::beam
