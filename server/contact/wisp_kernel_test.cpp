// Laws of finding where segments of wisps are closest, on every instruction set:
//   approach   equals ClosestPoints at rest; what comes is found where and when it is first within
//              its reach, but where corners pass
//   lanes      a lane's bits do not depend on the others, nor on its place
//   lines      nothing between two lines comes nearer within the step than is said
//   links      the nearest segments are those that all pairs of them tell, one by one

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "contact/test_segments.h"
#include "contact/wisp_kernels.h"
#include "math/random.h"
#include "simd/rows.h"
#include "simd/test_every_isa.h"

namespace mane::contact {
namespace {

using Eigen::Vector3f;
using simd::kLanes;

constexpr float kDt = 1.0f / 60;

class WispKernelTest : public simd::fixtures::EveryIsaTest<&WispKernelsFor> {
 protected:
  Vector3f Any(double size) {
    const auto coordinate = [&] { return static_cast<float>(random_.Uniform(-size, size)); };
    const float x = coordinate(), y = coordinate(), z = coordinate();
    return {x, y, z};
  }

  math::RandomStream random_{1, 0};
};

// Two segments, as they move, and the distance at which they touch.
struct Case {
  Vector3f x[4], u[4];
  float reach;

  [[nodiscard]] Segment At(int which, float time) const {
    const int k = 2 * which;
    return {x[k] + time * u[k], x[k + 1] + time * u[k + 1]};
  }
  [[nodiscard]] float Apart(float time) const {
    const Segment p = At(0, time), q = At(1, time);
    const ClosestFractions at = ClosestPoints(p, q);
    return (p.At(at.s) - q.At(at.t)).norm();
  }
};

std::array<float, kApproachRows> Approach(const WispKernels& kernels, const Case& of, size_t lane,
                                          const Case& others) {
  std::array<simd::Row<float>, kSegmentPairRows> in{};
  std::array<simd::Row<float>, kApproachRows> out{};
  for (size_t l = 0; l < kLanes; ++l) {
    const Case& mine = l == lane ? of : others;
    for (size_t row = 0; row < 12; ++row) {
      in[kEnds + row].lane[l] = mine.x[row / 3][static_cast<int>(row % 3)];
      in[kMotion + row].lane[l] = mine.u[row / 3][static_cast<int>(row % 3)];
    }
    in[kTouchAt].lane[l] = mine.reach;
  }
  kernels.approach(in[0].lane, kDt, out[0].lane);
  std::array<float, kApproachRows> result;
  for (size_t row = 0; row < result.size(); ++row) result[row] = out[row].lane[lane];
  return result;
}

Vector3f At(const std::array<float, kApproachRows>& rows, size_t row) {
  return {rows[row], rows[row + 1], rows[row + 2]};
}

TEST_F(WispKernelTest, SegmentsAtRestAreClosestWhereClosestPointsSays) {
  ForEveryIsa([&](const WispKernels& kernels) {
    for (int i = 0; i < 500; ++i) {
      Case of{};
      for (Vector3f& x : of.x) x = Any(0.015);
      if (i % 10 == 1) of.x[1] = of.x[0];  // Points,
      if (i % 10 == 2) of.x[3] = of.x[2];
      if (i % 10 == 3) of.x[1] = of.x[0], of.x[3] = of.x[2];
      if (i % 10 == 4) of.x[3] = of.x[2] + of.x[1] - of.x[0];  // and what is parallel.
      of.reach = 0.01f;
      const auto found = Approach(kernels, of, static_cast<size_t>(i) % kLanes, of);
      const ClosestFractions at = ClosestPoints(of.At(0, 0), of.At(1, 0));
      const Vector3f d = of.At(0, 0).At(at.s) - of.At(1, 0).At(at.t);
      EXPECT_NEAR(found[kLeastApart], d.norm(), 1e-6) << i;
      EXPECT_LT((At(found, kApart) - d).norm(), 2e-5f) << i;
      EXPECT_NEAR(found[kFractions], at.s, 2e-3) << i;
      EXPECT_NEAR(found[kFractions + 1], at.t, 2e-3) << i;
    }
  });
}

TEST_F(WispKernelTest, WhatComesTouchesWhenItIsFirstWithinReach) {
  ForEveryIsa([&](const WispKernels& kernels) {
    int touching = 0, late = 0;
    for (int i = 0; i < 500; ++i) {
      Case of{};
      // Two that move as wholes: what turns meanwhile is found to first order.
      const Vector3f u = Any(3), there = Any(0.03);
      const auto way = static_cast<float>(random_.Uniform(0.6, 1.4));  // Of what is between them.
      const Vector3f w = u + 2 * way / kDt * there + Any(0.1);
      for (size_t k = 0; k < 4; ++k) {
        of.x[k] = Any(0.008) + (k < 2 ? there : Vector3f(-there));
        of.u[k] = k < 2 ? u : w;
      }
      of.reach = 0.01f;
      const auto found = Approach(kernels, of, static_cast<size_t>(i) % kLanes, of);
      float first = kDt;
      for (int k = 500; k >= 0; --k) {
        const float time = kDt * static_cast<float>(k) / 500;
        if (of.Apart(time) <= of.reach) first = time;
      }
      if (first <= 0 || first >= kDt) continue;
      ++touching;
      const Vector3f moved = At(found, kTouching) - At(found, kApart);
      const float time = moved.dot(u - w) / (u - w).squaredNorm();
      const float apart = At(found, kTouching).norm();
      late += !(std::abs(time - first) < 0.05f * kDt && std::abs(apart - of.reach) < 1e-4f &&
                found[kLeastApart] < of.reach);
    }
    // Where they are closest then is looked for once: corners that pass may be missed.
    EXPECT_LT(late, 0.1 * touching);
    EXPECT_GT(touching, 30);
  });
}

TEST_F(WispKernelTest, ALaneDependsOnNothingElse) {
  ForEveryIsa([&](const WispKernels& kernels) {
    const auto any = [&] {
      Case of{};
      for (Vector3f& x : of.x) x = Any(0.02);
      for (Vector3f& u : of.u) u = Any(2);
      of.reach = 0.01f;
      return of;
    };
    for (int i = 0; i < 20; ++i) {
      const Case of = any();
      const auto alone = Approach(kernels, of, 0, of);
      for (size_t lane = 0; lane < kLanes; ++lane) {
        const auto beside = Approach(kernels, of, lane, any());
        EXPECT_EQ(std::memcmp(alone.data(), beside.data(), sizeof(alone)), 0) << lane;
      }
    }
  });
}

TEST_F(WispKernelTest, NothingBetweenLinesComesNearerThanIsSaid) {
  ForEveryIsa([&](const WispKernels& kernels) {
    for (int i = 0; i < 20; ++i) {
      std::array<simd::Row<float>, kSegmentPairRows> in{};
      std::array<simd::Row<float>, kLineRows> out{};
      for (size_t row = 0; row < 12; ++row) {
        for (float& number : in[kEnds + row].lane) number = Any(0.05).x();
        for (float& number : in[kMotion + row].lane) number = Any(0.02).x();
      }
      kernels.lines(in[0].lane, out[0].lane);
      for (size_t lane = 0; lane < kLanes; ++lane) {
        Case of{};
        for (size_t row = 0; row < 12; ++row) {
          of.x[row / 3][static_cast<int>(row % 3)] = in[kEnds + row].lane[lane];
          of.u[row / 3][static_cast<int>(row % 3)] = in[kMotion + row].lane[lane];
        }
        const float apart = out[kLinesApart].lane[lane], nearing = out[kLinesNearing].lane[lane];
        EXPECT_NEAR(apart, of.Apart(0), 2e-5);
        EXPECT_GE(nearing, 0);
        for (int k = 0; k <= 20; ++k) {
          EXPECT_GE(of.Apart(static_cast<float>(k) / 20), apart - nearing - 2e-4f) << k;
        }
      }
    }
  });
}

TEST_F(WispKernelTest, TheNearestSegmentsOfLinksAreThoseThatAllPairsTell) {
  ForEveryIsa([&](const WispKernels& kernels) {
    for (int i = 0; i < 300; ++i) {
      const int counts[2] = {1 + i % kLongestLink, 1 + i / 7 % kLongestLink};
      Vector3f place[2][kLongestLink + 1], sweep[2][kLongestLink + 1];
      float half[2] = {0, 0};
      for (int k = 0; k < 2; ++k) {
        place[k][0] = Any(0.05);
        for (int p = 0; p <= counts[k]; ++p) {
          if (p > 0) place[k][p] = place[k][p - 1] + Any(0.01);
          if (p > 0) half[k] = std::max(half[k], 0.5f * (place[k][p] - place[k][p - 1]).norm());
          sweep[k][p] = Any(0.02);
        }
      }
      float least = 1, least_within = 1;
      for (int a = 0; a < counts[0]; ++a) {
        for (int b = 0; b < counts[1]; ++b) {
          const Case of{{place[0][a], place[0][a + 1], place[1][b], place[1][b + 1]}, {}, 0};
          least = std::min(least, of.Apart(0));
          const auto middle = [&](const auto& x) -> Vector3f {
            return 0.5f * (x[0][a] + x[0][a + 1] - x[1][b] - x[1][b + 1]);
          };
          const Vector3f d = middle(place), w = middle(sweep);
          const float time = std::clamp(-d.dot(w) / w.squaredNorm(), 0.0f, 1.0f);
          least_within = std::min(least_within, (d + time * w).norm());
        }
      }
      const LinkPoints links[2] = {{place[0][0].data(), sweep[0][0].data(), counts[0], half[0]},
                                   {place[1][0].data(), sweep[1][0].data(), counts[1], half[1]}};
      const NearestSegments nearest = kernels.closest(links[0], links[1]);
      ASSERT_TRUE(nearest.segment[0] < counts[0] && nearest.segment[1] < counts[1]);
      const int a = nearest.segment[0], b = nearest.segment[1];
      const Case of{{place[0][a], place[0][a + 1], place[1][b], place[1][b + 1]}, {}, 0};
      EXPECT_NEAR(nearest.distance, least, 1e-5);
      EXPECT_NEAR(of.Apart(0), least, 1e-5);
      EXPECT_NEAR(kernels.closest_within(links[0], links[1]).distance, least_within, 1e-5);
    }
  });
}

}  // namespace
}  // namespace mane::contact
