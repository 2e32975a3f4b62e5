// Bounds hold for every point of a ball, of random maps and balls; they are close where the ball is
// small; those of images hold for every pixel of a box and stay near it.

#include "styling/map_bounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "math/random.h"
#include "styling/chart.h"
#include "styling/map.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

MapImage Noise(int width, int height, uint64_t seed) {
  MapImage image{width, height, std::vector<float>(size_t(width) * height)};
  math::RandomStream random(seed, 0);
  for (float& value : image.values) value = static_cast<float>(random.Uniform());
  return image;
}

std::vector<Stop> RandomStops(math::RandomStream& random, double low, double high) {
  std::vector<Stop> stops;
  const int n = static_cast<int>(random.Uniform() * 6);
  for (int i = 0; i < n; ++i) {
    stops.push_back({low + (high - low) * (i + random.Uniform()) / n, random.Uniform()});
  }
  return stops;
}

Vector3d InBall(math::RandomStream& random) {
  while (true) {
    const Vector3d x(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
    if (x.norm() <= 1) return x;
  }
}

TEST(MapBoundsTest, HoldForEveryPointOfABall) {
  math::RandomStream random(1, 0);
  const ScalpChart chart(groom::Ellipsoid{});
  for (int i = 0; i < 4000; ++i) {
    ScalpMap map{
        1 + random.Uniform(), RandomStops(random, 0, pi), RandomStops(random, -pi, pi), {}};
    if (i % 2 == 0) {
      map.image = std::make_shared<MapImage>(Noise(1 + i % 41, 1 + i % 23, i));
    }
    const MapBounds bounds(map);
    const Vector3d middle = InBall(random);
    const double radius = std::pow(10, random.Uniform(-4, 0));
    const auto [low, high] = bounds.Over(middle, radius);
    for (int k = 0; k < 60; ++k) {
      Vector3d x = InBall(random);
      if (k % 2 == 0) x.normalize();  // Extremes are at the surface, mostly.
      const double value = ValueAt(map, chart.At(middle + radius * x));
      ASSERT_GE(value, low - 1e-9) << i;
      ASSERT_LE(value, high + 1e-9) << i;
    }
  }
}

TEST(MapBoundsTest, AreCloseWhereTheBallIsSmall) {
  math::RandomStream random(2, 0);
  const ScalpMap map{1, {{0, 0}, {pi, 1}}, {{-pi, 0}, {0, 1}, {pi, 0}}, nullptr};
  const MapBounds bounds(map);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d middle = DirectionOf({random.Uniform(0.3, 2.8), random.Uniform(-pi, pi)});
    const auto [low, high] = bounds.Over(middle, 1e-3);
    // Slopes are 1 / pi each at most, azimuths change by 1 / sin(0.3) of the way; both ways.
    EXPECT_LT(high - low, 2e-3 / pi * (1 + 1 / std::sin(0.3)) + 1e-5);
  }
}

TEST(MapBoundsTest, BoxesOfPixels) {
  const MapImage image = Noise(61, 40, 3);
  const ImageBounds bounds(image);
  math::RandomStream random(4, 0);
  for (int i = 0; i < 5000; ++i) {
    int x0 = int(random.Uniform() * 61), x1 = int(random.Uniform() * 61);
    int y0 = int(random.Uniform() * 40), y1 = int(random.Uniform() * 40);
    if (x0 > x1) std::swap(x0, x1);
    if (y0 > y1) std::swap(y0, y1);
    const int margin = std::max(x1 - x0, y1 - y0) / 2;
    double low = 1, high = 0, wide_low = 1, wide_high = 0;
    for (int y = std::max(y0 - margin, 0); y <= std::min(y1 + margin, 39); ++y) {
      for (int x = std::max(x0 - margin, 0); x <= std::min(x1 + margin, 60); ++x) {
        const double value = image.values[y * 61 + x];
        wide_low = std::min(wide_low, value);
        wide_high = std::max(wide_high, value);
        if (x < x0 || x > x1 || y < y0 || y > y1) continue;
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
    const Bounds b = bounds.Over(x0, y0, x1, y1);
    ASSERT_LE(b.low, low);
    ASSERT_GE(b.high, high);
    ASSERT_GE(b.low, wide_low);
    ASSERT_LE(b.high, wide_high);
  }
}

}  // namespace
}  // namespace mane::styling
