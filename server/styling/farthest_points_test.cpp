// Cells of points that lie far apart: by their definition, in brute force.

#include "styling/farthest_points.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "math/random.h"

namespace mane::styling {
namespace {

std::vector<Eigen::Vector3f> Random(int count) {
  math::RandomStream random(3, 0);
  std::vector<Eigen::Vector3f> points(count);
  for (Eigen::Vector3f& p : points) {
    for (float& x : p) x = static_cast<float>(random.Uniform());
  }
  return points;
}

TEST(FarthestPointCells, AreOfTheNearestOfPointsThatLieFarApart) {
  const auto points = Random(500);
  const auto cells = FarthestPointCells(points, 20);
  // Middles again, one after the other: the point farthest from all before.
  std::vector<size_t> middles{0};
  const auto distance = [&](size_t i) {
    float least = 1e9F;
    for (const size_t middle : middles) {
      least = std::min(least, (points[i] - points[middle]).norm());
    }
    return least;
  };
  while (middles.size() < 20) {
    size_t farthest = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      if (distance(i) > distance(farthest)) farthest = i;
    }
    middles.push_back(farthest);
  }
  float largest = 0, apart = 1e9F;
  for (size_t i = 0; i < points.size(); ++i) {
    const float own = (points[i] - points[middles[cells[i]]]).norm();
    EXPECT_EQ(own, distance(i));
    largest = std::max(largest, own);
  }
  for (size_t a = 0; a < 20; ++a) {
    EXPECT_EQ(cells[middles[a]], a);
    for (size_t b = 0; b < a; ++b) {
      apart = std::min(apart, (points[middles[a]] - points[middles[b]]).norm());
    }
  }
  EXPECT_GE(apart, largest);
}

TEST(FarthestPointCells, AreAsManyAsPointsDiffer) {
  auto points = Random(3);
  points.insert(points.end(), points.begin(), points.begin() + 3);
  const auto cells = FarthestPointCells(points, 10);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(cells[i], cells[i + 3]);
  EXPECT_EQ(*std::ranges::max_element(cells), 2U);
  EXPECT_EQ(FarthestPointCells(points, 1), std::vector<uint32_t>(6, 0));
}

TEST(FarthestPointCells, OfEquallyNearOnesTheFirst) {
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {0.5F, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(FarthestPointCells(points, 2), (std::vector<uint32_t>{0, 0, 1}));
}

}  // namespace
}  // namespace mane::styling
