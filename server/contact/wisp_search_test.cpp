// Laws of how the pairs of wisps are found:
//   search     wherever two guides come within their radii there is a pair, as brute force finds
//   memory     hair that moves has the pairs that a search from nothing finds
//   sweep      guides that would cross within the step are a pair before they do
//   order      which of two guides is the first changes no pair
//   linear     pairs and time grow with the guides; what a step looks at, by counts, no faster

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>
#include <vector>

#include "contact/test_segments.h"
#include "contact/test_wisps.h"
#include "math/random.h"
#include "rod/scheme.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using fixtures::CpuTime;
using fixtures::Crossing;
using fixtures::FromTheRoot;
using fixtures::Hair;
using fixtures::HeadOfHair;
using fixtures::kDt;
using fixtures::Tracking;

// Least distance of two guides of 30 points beyond the root's 2 cm [m]: from the third point of
// their 12 mm segments on.
float LeastDistance(const WispPoints& points, int i, int j) {
  const auto segment = [&](int p) {
    return Segment{points.Position(static_cast<size_t>(p)),
                   points.Position(static_cast<size_t>(p) + 1)};
  };
  float least = 1;
  for (int p = 30 * i + 2; p < 30 * i + 29; ++p) {
    for (int q = 30 * j + 2; q < 30 * j + 29; ++q) {
      const ClosestFractions at = ClosestPoints(segment(p), segment(q));
      least = std::min(least, (segment(p).At(at.s) - segment(q).At(at.t)).norm());
    }
  }
  return least;
}

TEST(WispSearchTest, WhereverGuidesComeWithinTheirRadiiThereIsAPair) {
  WispSettings settings;
  for (const uint64_t seed : {1, 2}) {
    Hair hair = HeadOfHair(60, seed);
    math::RandomStream random(seed, 9);
    for (float& r : hair.radius) r *= static_cast<float>(random.Uniform(0.5, 1.5));
    Tracking tracking(settings);
    tracking.Begin(hair);
    std::map<std::pair<int, int>, float> nearest;
    for (const WispPair& pair : tracking.tracker.pairs()) {
      for (const int32_t point : pair.point) EXPECT_GE(point % 30, 2);  // Roots take no part.
      const auto [at, added] = nearest.try_emplace({pair.guide[0], pair.guide[1]}, 1.0f);
      at->second = std::min(at->second, pair.gap + pair.reference);
    }

    const WispPoints points = hair.View();
    int met = 0;
    for (int i = 0; i < 60; ++i) {
      for (int j = i + 1; j < 60; ++j) {
        const float least = LeastDistance(points, i, j);
        const float reach =
            hair.radius[static_cast<size_t>(i)] + hair.radius[static_cast<size_t>(j)];
        const auto found = nearest.find({i, j});
        if (least < reach) {
          ++met;
          ASSERT_NE(found, nearest.end()) << i << " " << j << ", apart " << least;
          EXPECT_LT(found->second, least + 0.1f * reach) << i << " " << j;
        } else if (least > 1.26f * reach) {
          EXPECT_EQ(found, nearest.end()) << i << " " << j;
        }
      }
    }
    EXPECT_GT(met, 60);
  }
}

// Least distance of the pairs of two guides, along their normals.
std::map<std::pair<int, int>, float> Nearest(const Tracking& tracking) {
  std::map<std::pair<int, int>, float> nearest;
  for (const WispPair& pair : tracking.tracker.pairs()) {
    const auto [at, added] = nearest.try_emplace({pair.guide[0], pair.guide[1]}, 1.0f);
    at->second = std::min(at->second, std::abs(pair.gap + pair.reference));
  }
  return nearest;
}

// Guides sway about their roots for a step, each in its own way; some directions last.
void Sway(int step, double speed, math::RandomStream* random, Hair* hair) {
  for (size_t g = 0; g + 1 < hair->first.size() && step % 12 == 0; ++g) {
    const Vector3d tip = speed * Vector3d(random->Normal(), random->Normal(), random->Normal());
    for (int32_t k = 0; k < 30; ++k) {
      const auto p = static_cast<size_t>(hair->first[g] + k);
      const double part = k / 29.0;
      hair->ux[p] = static_cast<float>(part * tip.x());
      hair->uy[p] = static_cast<float>(part * tip.y());
      hair->uz[p] = static_cast<float>(part * tip.z());
    }
  }
  for (size_t p = 0; p < hair->size(); ++p) {
    hair->x[p] += static_cast<float>(kDt) * hair->ux[p];
    hair->y[p] += static_cast<float>(kDt) * hair->uy[p];
    hair->z[p] += static_cast<float>(kDt) * hair->uz[p];
  }
}

TEST(WispSearchTest, HairThatMovesHasThePairsThatASearchFromNothingFinds) {
  for (const double speed : {0.05, 0.3, 1.5}) {
    Hair hair = HeadOfHair(80, 12);
    math::RandomStream random(13, 0);
    Tracking warm;
    int met = 0, missed = 0, farther = 0;
    for (int i = 0; i < 120; ++i) {
      Sway(i, speed, &random, &hair);
      warm.Begin(hair);
      Tracking fresh;
      fresh.Begin(hair);
      const auto found = Nearest(warm);
      for (const auto& [guides, distance] : Nearest(fresh)) {
        const float reach = hair.radius[0] + hair.radius[0];
        if (distance >= reach) continue;
        ++met;
        const auto at = found.find(guides);
        missed += at == found.end();
        farther += at != found.end() && at->second > distance + 0.1f * reach;
      }
    }
    std::printf("%.2f m/s: of %d that met %d missed, %d farther\n", speed, met, missed, farther);
    EXPECT_EQ(missed, 0) << speed;
    EXPECT_LT(farther, 0.01 * met) << speed;
  }
}

TEST(WispSearchTest, GuidesThatWouldCrossAreAPairBeforeTheyDo) {
  // 60 mm apart at the start; linearised at 0.55 of the step, they have come by 37 mm.
  Tracking tracking(FromTheRoot());
  const double h = rod::kTheta * kDt;
  tracking.Begin(Crossing(0.06 - 4 * h, -4));
  ASSERT_EQ(tracking.tracker.pairs().size(), 1u);
  const WispPair& pair = tracking.tracker.pairs()[0];
  EXPECT_NEAR(pair.gap, 0.05, 1e-5);
  EXPECT_LT((pair.normal - Vector3f(0, -1, 0)).norm(), 1e-5);  // From the second to the first.

  Tracking slower(FromTheRoot());
  slower.Begin(Crossing(0.06 - 2 * h, -2));
  EXPECT_TRUE(slower.tracker.pairs().empty());
}

// The same guides in the opposite order.
Hair Reversed(const Hair& hair) {
  Hair reversed;
  for (size_t g = hair.radius.size(); g-- > 0;) {
    reversed.AddGuide(hair.radius[g], hair.curliness[g]);
    for (int32_t k = hair.first[g]; k < hair.first[g + 1]; ++k) {
      const auto p = static_cast<size_t>(k);
      reversed.AddPoint(Vector3d(hair.x[p], hair.y[p], hair.z[p]),
                        Vector3d(hair.ux[p], hair.uy[p], hair.uz[p]), hair.mass[p]);
    }
  }
  return reversed;
}

TEST(WispSearchTest, WhichGuideIsFirstChangesNoPair) {
  constexpr int kGuides = 100, kPoints = 30;
  Hair hair = HeadOfHair(kGuides, 6);
  fixtures::Shake(0.3, 7, &hair);
  Tracking forward, backward;
  forward.Begin(hair);
  backward.Begin(Reversed(hair));
  // Where guides, by their numbers in `hair`, touch: places along the lower and the higher.
  const auto places = [](const Tracking& tracking, bool reversed) {
    std::map<std::pair<int, int>, std::vector<std::pair<double, double>>> all;
    for (const WispPair& pair : tracking.tracker.pairs()) {
      int guide[2];
      double place[2];
      for (int k = 0; k < 2; ++k) {
        const int side = reversed ? 1 - k : k;
        guide[k] = reversed ? kGuides - 1 - pair.guide[side] : pair.guide[side];
        place[k] = pair.point[side] % kPoints + pair.fraction[side];
      }
      all[{guide[0], guide[1]}].emplace_back(place[0], place[1]);
    }
    for (auto& [guides, at] : all) std::ranges::sort(at);
    return all;
  };
  const auto there = places(forward, false), back = places(backward, true);
  ASSERT_EQ(there.size(), back.size());
  EXPECT_GT(there.size(), 100U);
  for (const auto& [guides, at] : there) {
    ASSERT_TRUE(back.contains(guides)) << guides.first << " " << guides.second;
    const auto& other = back.at(guides);
    ASSERT_EQ(at.size(), other.size()) << guides.first << " " << guides.second;
    for (size_t k = 0; k < at.size(); ++k) {
      EXPECT_NEAR(at[k].first, other[k].first, 0.01);
      EXPECT_NEAR(at[k].second, other[k].second, 0.01);
    }
  }
}

TEST(WispSearchTest, PairsAndTimeGrowWithTheGuides) {
  for (const int guides : {50, 100, 500, 1000, 5000}) {
    Hair hair = HeadOfHair(guides, 4);
    hair.RestHere();
    fixtures::Shake(0.05, 5, &hair);
    Tracking tracking;
    double begin = 1e9, revise = 1e9;
    for (int i = 0; i < 3; ++i) {
      const double start = CpuTime();
      tracking.Begin(hair);
      const double begun = CpuTime();
      tracking.Revise(hair);
      begin = std::min(begin, begun - start);
      revise = std::min(revise, CpuTime() - begun);
    }
    const auto pairs = static_cast<double>(tracking.tracker.pairs().size());
    std::printf("%d guides: %.1f pairs a guide; Begin %.0f ns a point, Revise %.0f ns a pair\n",
                guides, pairs / guides, 1e9 * begin / static_cast<double>(hair.size()),
                1e9 * revise / pairs);
    EXPECT_LT(pairs / guides, 100) << guides;
    if (guides >= 500) {
      EXPECT_GT(pairs / guides, 5) << guides;
      continue;
    }
    int met = 0;
    for (int i = 0; i < guides; ++i) {
      for (int j = i + 1; j < guides; ++j) {
        met += LeastDistance(hair.View(), i, j) < hair.radius[0] + hair.radius[0];
      }
    }
    EXPECT_GE(pairs, met) << guides;
    EXPECT_GT(met, guides);
  }
}

TEST(WispSearchTest, WhatAStepLooksAtGrowsNoFasterThanTheGuides) {
  for (const double speed : {0.0, 0.2, 1.0}) {
    for (const int guides : {50, 100, 500, 1000, 5000}) {
      Hair hair = HeadOfHair(guides, 4);
      math::RandomStream random(5, 0);
      Tracking tracking;
      constexpr int kSteps = 6;
      double compared = 0, neighbours = 0, pairs = 0;
      for (int i = 0; i <= kSteps; ++i) {
        Sway(i, speed, &random, &hair);
        tracking.Begin(hair);
        if (i == 0) continue;  // Everything is new.
        compared += static_cast<double>(tracking.scratch.work.compared) / guides / kSteps;
        neighbours += static_cast<double>(tracking.scratch.work.neighbours) / guides / kSteps;
        pairs += static_cast<double>(tracking.tracker.pairs().size()) / guides / kSteps;
      }
      std::printf("%.1f m/s, %d guides: compares %.0f, %.0f neighbours, %.1f pairs a guide\n",
                  speed, guides, compared, neighbours, pairs);
      // By the budgets a point (contact.md, H3), of which small heads have some to spare.
      EXPECT_LT(compared, 12 * (30 + 14000.0 / guides)) << guides;
      EXPECT_LT(neighbours, 2.2 * (30 + 14000.0 / guides)) << guides;
      EXPECT_LT(pairs, 30) << guides;
      if (speed == 0) {
        EXPECT_EQ(compared, 0) << guides;  // What rests is not searched.
      }
    }
  }
}

}  // namespace
}  // namespace mane::contact
