// Laws of finding segments that may meet:
//   closest    closest points of two segments are as near as a fine search finds, to 0.2 mm
//   parallel   of parallel segments the middle of what they share, and nothing jumps near it
//   boxes      boxes of all sizes overlap as one by one

#include "contact/segment_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact/test_segments.h"
#include "math/random.h"

namespace mane::contact {
namespace {

using Eigen::Vector3f;

Vector3f RandomVector(math::RandomStream& random, double size) {
  const auto coordinate = [&] { return static_cast<float>(random.Uniform(-size, size)); };
  const float x = coordinate(), y = coordinate(), z = coordinate();
  return {x, y, z};
}

TEST(SegmentGridTest, ClosestPointsAreAsNearAsAFineSearchFinds) {
  math::RandomStream random(1, 0);
  for (int i = 0; i < 2000; ++i) {
    const Vector3f a = RandomVector(random, 0.01), c = RandomVector(random, 0.01);
    const float size = i % 10 == 0 ? 0 : 0.015f;  // Some are points.
    const Segment p{a, a + size / 0.01f * RandomVector(random, 0.01)};
    const Segment q{c, c + RandomVector(random, 0.015)};
    const ClosestFractions at = ClosestPoints(p, q);
    ASSERT_TRUE(at.s >= 0 && at.s <= 1 && at.t >= 0 && at.t <= 1);
    float least = 1;
    for (int k = 0; k <= 200; ++k) {
      // The nearest point of the second to one of the first.
      const Vector3f x = p.At(static_cast<float>(k) / 200), e = q.b - q.a;
      const float t = std::clamp(e.dot(x - q.a) / e.squaredNorm(), 0.0f, 1.0f);
      least = std::min(least, (x - q.At(t)).norm());
    }
    EXPECT_LT((p.At(at.s) - q.At(at.t)).norm(), least + 2e-4f) << i;
  }
}

TEST(SegmentGridTest, ParallelSegmentsTouchInTheMiddleOfWhatTheyShare) {
  const Segment p{{0, 0, 0}, {0.02f, 0, 0}};
  for (const float angle : {0.0f, 1e-4f, -1e-4f}) {
    const Segment q{{0.01f, 0.005f, 0}, {0.03f, 0.005f + 0.02f * angle, 0}};
    const ClosestFractions at = ClosestPoints(p, q);
    EXPECT_NEAR(at.s, 0.75, 0.05) << angle;
    EXPECT_NEAR(at.t, 0.25, 0.05) << angle;
  }
}

TEST(SegmentGridTest, BoxesOfAllSizesOverlapAsOneByOne) {
  math::RandomStream random(2, 0);
  for (const double spread : {0.05, 0.3, 3.0}) {
    std::vector<SegmentBox> boxes;
    for (int i = 0; i < 1500; ++i) {
      const Vector3f middle = RandomVector(random, spread);
      const double size = 0.01 * std::exp(random.Uniform(0, i % 50 == 0 ? 5 : 1));
      const Vector3f half = RandomVector(random, size).cwiseAbs();
      boxes.push_back({middle - half, middle + half, i % 7 == 0 ? -1 : i / 30});
    }
    SegmentGrid grid;
    grid.Build(boxes);
    for (int a = 0; a < 1500; ++a) {
      std::vector<int> found, expected;
      grid.ForOverlapping(a, [&](int b) { found.push_back(b); });
      std::sort(found.begin(), found.end());
      const SegmentBox& box = boxes[static_cast<size_t>(a)];
      for (int b = 0; b < 1500; ++b) {
        const SegmentBox& other = boxes[static_cast<size_t>(b)];
        if (box.guide < 0 || other.guide < 0 || !box.Overlaps(other)) continue;
        if (other.guide != box.guide) expected.push_back(b);
      }
      ASSERT_EQ(found, expected) << a;
    }
  }
}

}  // namespace
}  // namespace mane::contact
