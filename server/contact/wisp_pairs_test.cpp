// Laws of the pairs of wisps:
//   search     wherever two guides come within their radii there is a pair, as brute force finds
//   memory     hair that moves has the pairs that a search from nothing finds
//   sweep      guides that would cross within the step are a pair before they do
//   rest       wisps that overlap at rest feel nothing; without a rest shape, not when first met
//   order      which of two guides is the first changes no pair
//   relax      a distance that was met turns into that of the rest shape; what meets later keeps
//              that one at once
//   side       what crossed is pushed back to the side that it came from
//   forget     what is apart is no pair
//   linear     pairs and time grow with the guides; what a step looks at, by counts, no faster
//   workers    the same bits for any number of them, for copies too, and no allocation once warm
//   bounded    whatever comes in, what comes out is finite and bounded

#include "contact/wisp_pairs.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "base/test_allocations.h"
#include "contact/test_segments.h"
#include "contact/test_wisps.h"
#include "contact/wisp_impulse.h"
#include "math/random.h"
#include "rod/scheme.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using fixtures::CpuTime;
using fixtures::Hair;
using fixtures::HeadOfHair;
using fixtures::Impulses;

constexpr double kDt = 1.0 / 60;

// A tracker with what it needs.
struct Tracking {
  WispTracker tracker;
  WispScratch scratch;
  exec::WorkerPool pool;
  Impulses impulses{0};

  explicit Tracking(const WispSettings& settings = {}, int workers = 1)
      : tracker(settings), pool(workers) {}

  void Begin(const Hair& hair, double dt = kDt) {
    impulses = Impulses(hair.size());
    tracker.Begin(hair.View(), dt, scratch, pool, impulses.View());
  }
  void Revise(const Hair& moving) {
    tracker.Revise({moving.ux, moving.uy, moving.uz}, scratch, pool, impulses.View());
  }
};

WispSettings FromTheRoot() {
  WispSettings settings;
  settings.root_length = 0;
  return settings;
}

// Two guides of one segment each, that cross at right angles, `height` apart.
Hair Crossing(double height, double velocity) {
  Hair hair;
  hair.AddGuide(0.005f, 0);
  hair.AddPoint({-0.01, 0, 0}, Vector3d::Zero(), 1e-6);
  hair.AddPoint({0.01, 0, 0}, Vector3d::Zero(), 1e-6);
  hair.AddGuide(0.005f, 0);
  hair.AddPoint({0, height, -0.01}, {0, velocity, 0}, 1e-6);
  hair.AddPoint({0, height, 0.01}, {0, velocity, 0}, 1e-6);
  return hair;
}

TEST(WispPairsTest, WhereverGuidesComeWithinTheirRadiiThereIsAPair) {
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
    const auto segment = [&](int p) {
      return Segment{points.Position(static_cast<size_t>(p)),
                     points.Position(static_cast<size_t>(p) + 1)};
    };
    int met = 0;
    for (int i = 0; i < 60; ++i) {
      for (int j = i + 1; j < 60; ++j) {
        float least = 1;
        // Beyond the root's 2 cm: from the third point of 12 mm segments on.
        for (int p = 30 * i + 2; p < 30 * i + 29; ++p) {
          for (int q = 30 * j + 2; q < 30 * j + 29; ++q) {
            const ClosestFractions at = ClosestPoints(segment(p), segment(q));
            least = std::min(least, (segment(p).At(at.s) - segment(q).At(at.t)).norm());
          }
        }
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

TEST(WispPairsTest, HairThatMovesHasThePairsThatASearchFromNothingFinds) {
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
    // Guides stretch here, so that links begin and end where the root's 2 cm do, and with them what
    // others waited for.
    EXPECT_LT(missed, 1e-3 * met) << speed;
    EXPECT_LT(farther, 0.01 * met) << speed;
  }
}

TEST(WispPairsTest, GuidesThatWouldCrossAreAPairBeforeTheyDo) {
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

TEST(WispPairsTest, WispsThatOverlapAtRestFeelNothing) {
  const double weight = 9.81 * 1e-5 * kDt;  // Of about one point of 100 guides, in a step.
  for (const bool with_rest : {true, false}) {
    Hair hair = HeadOfHair(100, 3);
    if (with_rest) hair.RestHere();
    // The head is elsewhere, turned.
    const Eigen::Affine3d pose =
        Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized());
    for (size_t p = 0; p < hair.size(); ++p) {
      const Vector3d x = pose * Vector3d(hair.x[p], hair.y[p], hair.z[p]);
      hair.x[p] = static_cast<float>(x.x());
      hair.y[p] = static_cast<float>(x.y());
      hair.z[p] = static_cast<float>(x.z());
    }
    Tracking tracking;
    int overlapping = 0;
    double most = 0;
    for (int step = 0; step < (with_rest ? 60 : 1); ++step) {
      tracking.Begin(hair);
      for (int pass = 0; pass < 3; ++pass) {
        tracking.Revise(hair);
        for (size_t p = 0; p < hair.size(); ++p) {
          most = std::max(most, tracking.impulses.At(p).norm());
        }
      }
    }
    for (const WispPair& pair : tracking.tracker.pairs()) {
      const float reach = hair.radius[0] + hair.radius[0];
      overlapping += pair.gap + pair.reference < 0.9f * reach;
    }
    EXPECT_GT(overlapping, 100);
    EXPECT_LT(most, 2e-2 * weight);
  }
}

TEST(WispPairsTest, ADistanceThatWasMetTurnsIntoThatOfTheRestShape) {
  for (const double at_rest : {0.007, 0.03}) {
    Hair hair = Crossing(at_rest, 0);
    hair.RestHere();
    for (size_t p : {2, 3}) hair.y[p] = 0.004f;
    Tracking tracking(FromTheRoot());
    tracking.Begin(hair);
    ASSERT_EQ(tracking.tracker.pairs().size(), 1u);
    EXPECT_NEAR(tracking.tracker.pairs()[0].reference, 0.004, 1e-6);
    for (int i = 0; i < 60; ++i) tracking.Begin(hair);
    const double end = std::min(at_rest, 0.01);  // The radii's sum at most.
    EXPECT_NEAR(tracking.tracker.pairs()[0].reference, end + (0.004 - end) * std::exp(-1), 1e-5);
    for (int i = 0; i < 600; ++i) tracking.Begin(hair);
    EXPECT_NEAR(tracking.tracker.pairs()[0].reference, end, 1e-5);
  }
}

TEST(WispPairsTest, WhatMeetsLaterKeepsTheDistanceOfTheRestShape) {
  for (const double at_rest : {0.007, 0.03}) {
    Hair hair = Crossing(at_rest, 0);
    hair.RestHere();
    for (size_t p : {2, 3}) hair.y[p] = 0.03f;
    Tracking tracking(FromTheRoot());
    tracking.Begin(hair);
    ASSERT_TRUE(tracking.tracker.pairs().empty());
    for (size_t p : {2, 3}) hair.y[p] = 0.004f;  // It was too fast to be seen.
    tracking.Begin(hair);
    ASSERT_EQ(tracking.tracker.pairs().size(), 1u);
    EXPECT_NEAR(tracking.tracker.pairs()[0].reference, std::min(at_rest, 0.01), 1e-6);

    tracking.tracker.Clear();  // It is put there.
    tracking.Begin(hair);
    EXPECT_NEAR(tracking.tracker.pairs()[0].reference, 0.004, 1e-6);
  }
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

TEST(WispPairsTest, WhichGuideIsFirstChangesNoPair) {
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

TEST(WispPairsTest, WhatCrossedIsPushedBackToTheSideThatItCameFrom) {
  Tracking tracking(FromTheRoot());
  tracking.Begin(Crossing(0.008, 0));
  const Vector3f normal = tracking.tracker.pairs()[0].normal;
  for (const double height : {-0.003, -0.012, -0.018}) {  // The latter ones are out of reach.
    tracking.Begin(Crossing(height, 0));
    ASSERT_EQ(tracking.tracker.pairs().size(), 1u) << height;
    const WispPair& pair = tracking.tracker.pairs()[0];
    EXPECT_LT((pair.normal - normal).norm(), 1e-3);
    EXPECT_NEAR(pair.gap, height - pair.reference, 1e-5);
    tracking.Revise(Crossing(height, 0));
    EXPECT_GT(tracking.impulses.At(2).y(), 0);
    EXPECT_LT(tracking.impulses.At(0).y(), 0);
  }

  // It comes all the way back, at the speed of recovery at most.
  fixtures::Rods rods;
  rods.settings.root_length = 0;
  rods.Add({-0.05, 0, 0}, {0.05, 0, 0}, 11, 1e-4, 0.005f, 0, Vector3d::Zero(), true);
  rods.Add({0, 0.009, -0.05}, {0, 0.009, 0.05}, 11, 1e-4, 0.005f, 0, Vector3d::Zero(), true);
  rods.Step(kDt);
  rods.Shift(1, {0, -0.015, 0});
  for (int i = 0; i < 60; ++i) {
    rods.Step(kDt);
    EXPECT_LT(rods.MeanVelocity(1).y() - rods.MeanVelocity(0).y(), 0.2);
  }
  EXPECT_GT((rods.Centre(1) - rods.Centre(0)).y(), 0.0085);
}

TEST(WispPairsTest, WhatIsApartIsForgotten) {
  Tracking tracking(FromTheRoot());
  tracking.Begin(Crossing(0.008, 0));
  tracking.Begin(Crossing(0.013, 0));
  EXPECT_TRUE(tracking.tracker.pairs().empty());
  tracking.Begin(Crossing(-0.008, 0));  // It may come back on any side.
  EXPECT_GT(tracking.tracker.pairs()[0].normal.y(), 0);
  tracking.Begin(Crossing(0.025, 0));  // And what crossed, if it is too far off.
  EXPECT_TRUE(tracking.tracker.pairs().empty());
}

TEST(WispPairsTest, PairsAndTimeGrowWithTheGuides) {
  double per_guide = 0;
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
    per_guide = pairs / guides;
    EXPECT_LT(per_guide, 100) << guides;
    EXPECT_GT(per_guide, 3) << guides;
  }
}

TEST(WispPairsTest, WhatAStepLooksAtGrowsNoFasterThanTheGuides) {
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

// The pairs and impulses of some steps of shaken hair.
struct Record {
  std::vector<float> numbers;

  void Add(const Tracking& tracking) {
    for (const auto* list : {&tracking.impulses.x, &tracking.impulses.y, &tracking.impulses.z}) {
      numbers.insert(numbers.end(), list->begin(), list->end());
    }
    for (const WispPair& pair : tracking.tracker.pairs()) {
      numbers.insert(numbers.end(),
                     {static_cast<float>(pair.point[0]), static_cast<float>(pair.point[1]),
                      pair.gap, pair.reference, pair.normal_mass, pair.sliding_mass});
    }
  }
};

void Simulate(int from, int to, Hair& hair, Tracking& tracking, Record* record) {
  for (int step = from; step < to; ++step) {
    for (size_t p = 0; p < hair.size(); ++p) {
      hair.x[p] += static_cast<float>(kDt) * hair.ux[p];
      hair.y[p] += static_cast<float>(kDt) * hair.uy[p];
      hair.z[p] += static_cast<float>(kDt) * hair.uz[p];
    }
    fixtures::Shake(0.3, static_cast<uint64_t>(step), &hair);
    tracking.Begin(hair);
    Hair moving = hair;
    for (int pass = 0; pass < 3; ++pass) {
      fixtures::Shake(0.3, static_cast<uint64_t>(100 * step + pass), &moving);
      tracking.Revise(moving);
      if (record) record->Add(tracking);
    }
  }
}

TEST(WispPairsTest, AnyNumberOfWorkersGivesTheSameBitsAndSoDoesACopy) {
  for (const int guides : {150, 800}) {  // In the larger one links wait for their turn.
    std::vector<Record> records;
    for (const int workers : {1, 2, 5}) {
      Hair hair = HeadOfHair(guides, 6);
      Tracking tracking({}, workers);
      records.emplace_back();
      Simulate(0, 8, hair, tracking, &records.back());
      EXPECT_TRUE(records.back().numbers == records.front().numbers) << workers;
    }

    Hair hair = HeadOfHair(guides, 6);
    Tracking original, copy;
    Record by_copy;
    Simulate(0, 4, hair, original, &by_copy);
    copy.tracker = original.tracker;
    Simulate(4, 8, hair, copy, &by_copy);
    EXPECT_TRUE(by_copy.numbers == records.front().numbers) << guides;
  }
}

TEST(WispPairsTest, AWarmTrackerAllocatesNothing) {
  Hair hair = HeadOfHair(150, 7);
  fixtures::Shake(0.3, 8, &hair);
  Tracking tracking;
  const auto step = [&] {
    tracking.tracker.Begin(hair.View(), kDt, tracking.scratch, tracking.pool,
                           tracking.impulses.View());
    for (int pass = 0; pass < 3; ++pass) tracking.Revise(hair);
  };
  tracking.impulses = Impulses(hair.size());
  for (int i = 0; i < 3; ++i) step();
  const mane::fixtures::AllocationCount count;
  for (int i = 0; i < 3; ++i) step();
  EXPECT_EQ(count.count(), 0);
}

TEST(WispPairsTest, WhateverComesInWhatComesOutIsBounded) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  math::RandomStream random(10, 0);
  Tracking tracking(FromTheRoot());
  for (int i = 0; i < 40; ++i) {
    Hair hair = HeadOfHair(40, 11);
    hair.RestHere();
    fixtures::Shake(std::pow(10, random.Uniform(-3, 4)), random.Bits(), &hair);
    std::fill(hair.mass.begin(), hair.mass.end(), 1e-5f);
    Hair moving = hair;
    fixtures::Shake(std::pow(10, random.Uniform(-3, 6)), random.Bits(), &moving);
    std::vector<float>* lists[] = {&hair.x,      &hair.y,    &hair.z,         &hair.ux,
                                   &hair.uy,     &hair.uz,   &hair.rest_x,    &hair.rest_z,
                                   &hair.radius, &moving.ux, &hair.curliness, &moving.uy,
                                   &hair.mass};
    for (std::vector<float>* list : lists) {
      const bool mass = list == &hair.mass;
      for (const float absurd : {nan, infinity, -infinity, 1e30f, -1e30f, 1e4f, 0.0f, 1e-30f}) {
        // Masses that are too large to be hair's, but no absurd ones, would be stopped as such.
        if (mass && absurd == 1e4f) continue;
        (*list)[random.Bits() % list->size()] = absurd;
      }
    }
    const double dt = std::pow(10, random.Uniform(-9, 9));
    tracking.Begin(hair, i == 0 ? std::nan("") : dt);
    for (int pass = 0; pass < 4; ++pass) {
      for (size_t p = 0; p < hair.size(); ++p) {
        ASSERT_TRUE(tracking.impulses.At(p).allFinite()) << p;
      }
      for (const WispPair& pair : tracking.tracker.pairs()) {
        // (H12) with the largest factor, and the first pass's (H7).
        ASSERT_LE(pair.impulse.norm(), 64 * 2 * 1e-5 * (2 * 100 + 1));
        ASSERT_NEAR(pair.normal.norm(), 1, 1e-3);
      }
      tracking.Revise(moving);
    }
  }
}

}  // namespace
}  // namespace mane::contact
