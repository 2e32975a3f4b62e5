#include "styling/hairdressing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "styling/equal.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;

Region Back() {
  Region region;
  region.azimuth = Region::Interval{2, -2};
  return region;
}

TEST(HairdressingTest, CuttingAndWavingTouchTheirRegionOnly) {
  Style style;
  Dress({"", Back(), Operation::Trim{0.1, {}}}, &style);
  Dress({"", Back(), Operation::Wave{{{StrandKind::kCurly, 0, 0, {}}, 0, 0}}}, &style);
  ASSERT_EQ(style.cuts.size(), 1U);
  EXPECT_TRUE(style.cuts[0].region == Back());
  EXPECT_EQ(style.cuts[0].length, 0.1);
  ASSERT_EQ(style.regional.size(), 1U);
  EXPECT_EQ(style.regional[0].synthesis.prototype.kind, StrandKind::kCurly);
  EXPECT_EQ(style.synthesis.prototype.kind, StrandKind::kStraight);
  EXPECT_TRUE(style.queues.empty());
}

TEST(HairdressingTest, WhatIsDoneToTheSameHairFollowsInOneQueue) {
  Style style;
  Dress({"", Back(), Operation::Comb{{Vector3d(0, 0.1, 0), Vector3d(0, 0, -0.1)}, 0.05, 0.7}},
        &style);
  Dress({"", Back(), Operation::Tie{Vector3d(0, 0, -0.12), 0.02}}, &style);
  Dress({"", {}, Operation::Tie{Vector3d(0, 0.1, 0), 0.02}}, &style);
  ASSERT_EQ(style.queues.size(), 2U);
  ASSERT_EQ(style.queues[0].constraints.size(), 2U);
  EXPECT_EQ(style.queues[0].constraints[0].kind, Constraint::Kind::kDirection);
  EXPECT_EQ(style.queues[0].constraints[0].weight, 0.7);
  EXPECT_EQ(style.queues[0].constraints[1].kind, Constraint::Kind::kPoint);
  EXPECT_EQ(style.queues[0].constraints[1].weight, 1);
}

TEST(HairdressingTest, ABraidDealsItsHairOutAndKeepsWhatLedItThere) {
  Style style;
  Dress({"", Back(), Operation::Tie{Vector3d(0, 0, -0.12), 0.02}}, &style);
  Dress({"", Back(), Operation::Braid{{Vector3d(0, 0, -0.12), Vector3d(0, -0.4, -0.14)}}}, &style);
  ASSERT_EQ(style.queues.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(style.queues[i].share, i);
    EXPECT_EQ(style.queues[i].share_count, 3);
    ASSERT_EQ(style.queues[i].constraints.size(), 4U);
    EXPECT_EQ(style.queues[i].constraints[0].path[0], Vector3d(0, 0, -0.12));
    EXPECT_EQ(style.queues[i].constraints[2].kind, Constraint::Kind::kTrajectory);
    EXPECT_EQ(style.queues[i].constraints[1].path[0], style.queues[i].constraints[2].path[0]);
    EXPECT_EQ(style.queues[i].constraints[3].path[0], style.queues[0].constraints[3].path[0]);
  }
}

// The strands of a braid change their order across it, and where two of them pass each other one is
// in front by what keeps them apart.
TEST(HairdressingTest, StrandsOfABraidCrossWithoutMeeting) {
  const std::vector<Vector3d> axis{Vector3d(0, 0, 0), Vector3d(0, -0.15, 0), Vector3d(0, -0.3, 0)};
  const double radius = 0.02;
  std::vector<std::vector<Vector3d>> strands;
  for (int i = 0; i < 3; ++i) strands.push_back(BraidStrand(axis, i, 3, radius, 0.1));
  int changes = 0;
  for (size_t k = 0; k < strands[0].size(); ++k) {
    for (int i = 0; i < 3; ++i) {
      const Vector3d& a = strands[i][k];
      const Vector3d& b = strands[(i + 1) % 3][k];
      EXPECT_LE(std::hypot(a.x(), a.z()), radius * 1.13);
      EXPECT_NEAR(a.y(), -0.3 * static_cast<double>(k) / static_cast<double>(strands[0].size() - 1),
                  1e-12);
      EXPECT_GT((a - b).norm(), 0.8 * radius);
      if (k == 0) continue;
      const double before = strands[i][k - 1].x() - strands[(i + 1) % 3][k - 1].x();
      changes += (a.x() - b.x()) * before < 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(changes, 18);  // Each of three pairs twice a period, three periods.
  // A period further on every strand is back in its place.
  EXPECT_NEAR(strands[0].front().x(), strands[0].back().x(), 1e-12);
}

TEST(HairdressingTest, ABraidBendsWithItsAxis) {
  std::vector<Vector3d> arc;
  for (int i = 0; i <= 40; ++i) {
    const double angle = 1.5 * i / 40;
    arc.emplace_back(0, -0.3 * std::sin(angle), -0.3 * (1 - std::cos(angle)));
  }
  for (const Vector3d& p : BraidStrand(arc, 1, 3, 0.02, 0.1)) {
    double nearest = 1;
    for (const Vector3d& a : arc) nearest = std::min(nearest, (p - a).norm());
    EXPECT_LT(nearest, 0.0245);
  }
}

}  // namespace
}  // namespace mane::styling
