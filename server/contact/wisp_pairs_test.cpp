// Laws of the pairs of wisps, once they are found (wisp_search_test.cpp):
//   rest       wisps that overlap at rest feel nothing; without a rest shape, not when first met
//   relax      a distance that was met turns into that of the rest shape; what meets later keeps
//              that one at once
//   side       what crossed is pushed back to the side that it came from
//   forget     what is apart is no pair, but what parts may turn round within the step
//   passing    what turns round all at once is stopped before it is through; only its pairs are
//              revised for it
//   workers    the same bits for any number of them, for copies too, and no allocation once warm
//   bounded    whatever comes in, what comes out is finite and bounded

#include "contact/wisp_pairs.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/test_allocations.h"
#include "contact/test_wisps.h"
#include "contact/wisp_impulse.h"
#include "math/random.h"
#include "rod/scheme.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using fixtures::Crossing;
using fixtures::FromTheRoot;
using fixtures::Hair;
using fixtures::HeadOfHair;
using fixtures::Impulses;
using fixtures::kDt;
using fixtures::Tracking;

TEST(WispPairsTest, WispsThatOverlapAtRestFeelNothing) {
  const double weight = 9.81 * 4e-6 * kDt;  // Of about one point of 250 guides, in a step.
  for (const bool with_rest : {true, false}) {
    Hair hair = HeadOfHair(250, 3);
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
    EXPECT_GT(overlapping, 300);
    EXPECT_LT(most, 2e-2 * weight);
  }
}

// Puts the second guide of a crossing so high [m].
void PutAt(double height, Hair* crossing) {
  for (const size_t p : {2, 3}) crossing->y[p] = static_cast<float>(height);
}

TEST(WispPairsTest, ADistanceThatWasMetTurnsIntoThatOfTheRestShape) {
  for (const double at_rest : {0.007, 0.03}) {
    Hair hair = Crossing(at_rest, 0);
    hair.RestHere();
    PutAt(0.004, &hair);
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
    PutAt(0.03, &hair);
    Tracking tracking(FromTheRoot());
    tracking.Begin(hair);
    ASSERT_TRUE(tracking.tracker.pairs().empty());
    PutAt(0.004, &hair);  // It was too fast to be seen.
    tracking.Begin(hair);
    ASSERT_EQ(tracking.tracker.pairs().size(), 1u);
    EXPECT_NEAR(tracking.tracker.pairs()[0].reference, std::min(at_rest, 0.01), 1e-6);

    tracking.tracker.Clear();  // It is put there.
    tracking.Begin(hair);
    EXPECT_NEAR(tracking.tracker.pairs()[0].reference, 0.004, 1e-6);
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

TEST(WispPairsTest, WhatPartsFastMayTurnRound) {
  const double away = 0.0145, h = rod::kTheta * kDt;  // Out of reach by 2 mm.
  for (const double speed : {0.05, 0.3}) {
    Tracking tracking(FromTheRoot());
    tracking.Begin(Crossing(0.008, 0));
    tracking.Begin(Crossing(away + h * speed, speed));
    const bool goes_on = kDt * speed > 0.002;
    EXPECT_EQ(tracking.tracker.pairs().size(), goes_on ? 1u : 0u) << speed;
    tracking.Begin(Crossing(-0.004, 0));  // It is through all at once.
    ASSERT_EQ(tracking.tracker.pairs().size(), 1u);
    EXPECT_EQ(tracking.tracker.pairs()[0].normal.y() < 0, goes_on) << speed;
  }
}

TEST(WispPairsTest, WhatTurnsRoundAllAtOnceIsStopped) {
  for (const int more : {0, 3}) {
    fixtures::Rods rods;
    rods.settings.root_length = 0;
    rods.more_passes = more;
    rods.WatchDistance();
    for (const double z : {-0.035, 0.0, 0.035}) {
      rods.Add({-0.05, 0, z}, {0.05, 0, z}, 11, 1e-4, 0.005f, 0, Vector3d::Zero(), true);
    }
    // It lies over them and is thrown down by 8 m/s within a step.
    rods.Add({0, 0.011, -0.05}, {0, 0.011, 0.05}, 11, 1e-4, 0.005f, 0, Vector3d::Zero(), true,
             {0, -480, 0});
    rods.weight_scale = 0;
    rods.Step(kDt);
    rods.weight_scale = 1;
    rods.Step(kDt);
    rods.weight_scale = 0;
    for (int i = 0; i < 30; ++i) rods.Step(kDt);
    if (more == 0) {
      EXPECT_LT(rods.least_distance(), 0.001);  // It hardly is without.
    } else {
      EXPECT_GT(rods.least_distance(), 0.003);
    }
    EXPECT_GT((rods.Centre(3) - rods.Centre(1)).y(), 0.01);
  }
}

TEST(WispPairsTest, OnlyWhatWouldPassIsRevised) {
  // Two crossings a metre apart, of which the second goes fast all at once.
  Hair hair = Crossing(0.011, 0);
  const Hair same = Crossing(0.011, 0);
  for (int g = 0; g < 2; ++g) {
    hair.AddGuide(0.005f, 0);
    for (size_t p = 2 * g; p < 2u * g + 2; ++p) {
      hair.AddPoint({same.x[p] + 1.0, same.y[p], same.z[p]}, Vector3d::Zero(), 1e-6);
    }
  }
  Tracking tracking(FromTheRoot());
  tracking.Begin(hair);
  ASSERT_EQ(tracking.tracker.pairs().size(), 2u);
  Hair moving = hair;
  for (size_t p = 0; p < 4; ++p) moving.uy[p] = p < 2 ? 0.0f : -0.05f;
  tracking.Revise(moving);
  const Impulses before = tracking.impulses;
  const auto revise = [&] {
    const auto guides = tracking.RevisePassing(moving);
    return std::vector<int32_t>(guides.begin(), guides.end());
  };
  EXPECT_TRUE(revise().empty());
  EXPECT_EQ(tracking.impulses.y, before.y);
  for (size_t p = 6; p < 8; ++p) moving.uy[p] = -1;  // 17 mm in the step.
  EXPECT_EQ(revise(), (std::vector<int32_t>{2, 3}));
  for (size_t p = 0; p < 8; ++p) {
    EXPECT_EQ(tracking.impulses.y[p] == before.y[p], p < 4) << p;
  }
  EXPECT_GT(tracking.impulses.At(6).y(), 0);
  EXPECT_LT(tracking.impulses.Sum().norm(), 1e-6 * tracking.impulses.SumOfNorms());
}

TEST(WispPairsTest, OfManyThatWouldPassTheWorstAreRevised) {
  Hair hair;
  const Hair one = Crossing(0.011, 0);
  constexpr int kCrossings = 20;
  for (int i = 0; i < kCrossings; ++i) {
    for (int g = 0; g < 2; ++g) {
      hair.AddGuide(0.005f, 0);
      for (size_t p = 2 * g; p < 2u * g + 2; ++p) {
        hair.AddPoint({one.x[p] + 0.1 * i, one.y[p], one.z[p]}, Vector3d::Zero(), 1e-6);
      }
    }
  }
  Tracking tracking(FromTheRoot());
  tracking.Begin(hair);
  Hair moving = hair;  // The later the faster.
  for (size_t i = 0; i < kCrossings; ++i) {
    for (size_t p = 4 * i + 2; p < 4 * i + 4; ++p) moving.uy[p] = -1 - 0.1f * static_cast<float>(i);
  }
  const auto guides = tracking.RevisePassing(moving);
  ASSERT_EQ(guides.size(), 16u);
  EXPECT_EQ(guides.front(), 2 * (kCrossings - 8));
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
    fixtures::Shake(3, static_cast<uint64_t>(step), &moving);  // So that some would pass.
    EXPECT_FALSE(tracking.RevisePassing(moving).empty());
    if (record) record->Add(tracking);
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
  Hair moving = hair;
  fixtures::Shake(3, 8, &moving);
  const mane::fixtures::AllocationCount count;
  for (int i = 0; i < 3; ++i) step();
  const size_t revised = tracking.RevisePassing(moving).size();  // None was before.
  EXPECT_EQ(count.count(), 0);
  EXPECT_GT(revised, 0u);
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
      if (pass < 2) tracking.Revise(moving);
      if (pass >= 2) (void)tracking.RevisePassing(moving);
    }
  }
}

}  // namespace
}  // namespace mane::contact
