// Laws of constrained wisps:
//   point       w = 1 gathers all wisps within the tolerance, whatever the stiffness; they wait
//   trajectory  is followed within its tolerance to its end, where it curves too
//   direction   aligns within its influence and does nothing outside
//   weight      0 is no constraint, bit for bit; between, one segment is the closed form of (7)
//   report      a wisp that is too short has missed, and blocks nobody

#include <gtest/gtest.h>

#include <cmath>

#include "styling/solver.h"
#include "styling/solver_fixture.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using fixtures::Hair;
using fixtures::Solve;
using Kind = Constraint::Kind;

void Select(Hair* hair, const std::vector<Constraint>& constraints, uint32_t wisps) {
  hair->input.queues.push_back({});
  hair->input.queues.back().constraints = constraints;
  auto& selected = hair->input.selected.emplace_back();
  for (uint32_t w = 0; w < wisps; ++w) selected.push_back(w);
}

std::vector<Vector3f> OutlineOf(const Masters& masters, size_t w) {
  return {masters.outline.begin() + masters.first_joint[w],
          masters.outline.begin() + masters.first_joint[w + 1]};
}

TEST(SolverConstraintTest, APointGathersWhateverTheStiffness) {
  const Vector3d tie(0, 0.02, -0.14);
  for (const double kappa : {0.0, 0.5, 5.0}) {
    Hair hair = fixtures::HairOn(fixtures::Head(), 200, 50, 0.01, 50);
    hair.input.bending_stiffness = kappa;
    Select(&hair, {{Kind::kPoint, {tie}, 0.01, 1}}, 200);
    const Deformed solved = Solve(&hair);
    EXPECT_EQ(solved.report.constraints[0][0].met, 200);
    EXPECT_EQ(solved.report.constraints[0][0].missed, 0);
    for (size_t w = 0; w < 200; ++w) {
      double nearest = 1;
      for (const Vector3f& c : OutlineOf(hair.masters, w)) {
        nearest = std::min(nearest, (c.cast<double>() - tie).norm());
      }
      EXPECT_LE(nearest, 0.01);
    }
  }
}

TEST(SolverConstraintTest, WhoHasMetItWaitsForTheOthers) {
  // Two wisps at 5 and 20 segments from a point, then a trajectory down the x axis: the first must
  // not be deeper in it than the second, and both begin it in the same round, which shows in what
  // each sees of the other: alone, the first is not in the way of anything.
  const Vector3d point(0, 0, 0);
  Hair hair = fixtures::WispAt({0, 0.05, 0}, Vector3d::UnitX(), 40, 0.01);
  fixtures::AddWisp(&hair, {0, 0.2, 0}, Vector3d::UnitX(), 40, 10);
  Select(&hair, {{Kind::kPoint, {point}, 0.004, 1}}, 2);
  // A round's progress tells how many wisps grew in it.
  exec::WorkerPool pool(1);
  std::vector<int> grown;
  double last = 0;
  const auto solved = Deform(
      hair.input, &hair.masters, {},
      [&](double share) {
        grown.push_back(static_cast<int>(std::lround((share - last) * 80)));
        last = share;
      },
      &pool);
  ASSERT_TRUE(solved);
  // 5 rounds of both, 15 of the second alone, then 20 + 20 of both; 15 of the first alone.
  std::vector<int> expected(5, 2);
  expected.insert(expected.end(), 15, 1);
  expected.insert(expected.end(), 20, 2);
  expected.insert(expected.end(), 15, 1);
  EXPECT_EQ(grown, expected);
  EXPECT_EQ(solved->report.constraints[0][0].met, 2);
}

TEST(SolverConstraintTest, AShortWispMissesAndBlocksNobody) {
  Hair hair = fixtures::WispAt({0, 0.05, 0}, Vector3d::UnitX(), 10, 0.01);
  fixtures::AddWisp(&hair, {0, 0.2, 0}, Vector3d::UnitX(), 10, 10);
  Select(&hair,
         {{Kind::kPoint, {Vector3d::Zero()}, 0.004, 1},
          {Kind::kPoint, {Vector3d(0.03, 0, 0)}, 0.004, 1}},
         2);
  const auto reports = Solve(&hair).report.constraints[0];
  for (const ConstraintReport& report : reports) {
    EXPECT_EQ(report.selected, 2);
    EXPECT_EQ(report.met, 1);
    EXPECT_EQ(report.missed, 1);
  }
}

TEST(SolverConstraintTest, ATrajectoryIsFollowedWithinItsTolerance) {
  // A spiral of 2 cm radius and 3 cm pitch, two turns.
  std::vector<Vector3d> spiral;
  for (double a = 0; a <= 4 * M_PI; a += 0.05) {
    spiral.emplace_back(0.02 * std::cos(a), -0.03 / (2 * M_PI) * a, 0.02 * std::sin(a));
  }
  const Path path(spiral);
  for (const double radius : {0.01, 0.004}) {
    Hair hair = fixtures::WispAt({0.02, 0.03, -0.02}, Vector3d::UnitX(), 60, 0.005);
    Select(&hair, {{Kind::kTrajectory, spiral, radius, 1}}, 1);
    const auto report = Solve(&hair).report.constraints[0][0];
    EXPECT_EQ(report.met, 1);
    bool joined = false;
    double arc = 0, worst = 0;
    for (const Vector3f& c : hair.masters.outline) {
      const PathPlace place = path.Nearest(c.cast<double>(), arc, arc + 0.02);
      joined = joined || place.distance <= radius;
      if (!joined || place.arc >= path.length() - radius) continue;
      EXPECT_GE(place.arc, arc);
      arc = place.arc;
      worst = std::max(worst, place.distance);
    }
    EXPECT_GT(arc, path.length() - radius - 0.006);
    EXPECT_LE(worst, radius * 1.01);
  }
}

TEST(SolverConstraintTest, ADirectionAlignsWithinItsInfluenceOnly) {
  const std::vector<Vector3d> comb{{-0.1, -0.1, 0}, {0.3, -0.1, 0}};
  Hair hair = fixtures::WispAt({0, 0, 0}, -Vector3d::UnitY(), 30, 0.01);
  fixtures::AddWisp(&hair, {0, 0, 0.2}, -Vector3d::UnitY(), 30, 10);
  Hair free = hair;
  Select(&hair, {{Kind::kDirection, comb, 0.02, 1}}, 2);
  const auto report = Solve(&hair).report.constraints[0][0];
  Solve(&free);
  const auto combed = OutlineOf(hair.masters, 0);
  int aligned = 0;
  for (size_t j = 0; j + 1 < combed.size(); ++j) {
    const Vector3f q = (combed[j + 1] - combed[j]) / 0.01f;
    if (std::abs(combed[j].y() + 0.1f) <= 0.02f) {
      EXPECT_LT((q - Vector3f::UnitX()).norm(), 1e-3);
      ++aligned;
    } else {
      EXPECT_LT((q + Vector3f::UnitY()).norm(), 1e-3);
    }
  }
  EXPECT_GT(aligned, 15);
  EXPECT_EQ(OutlineOf(hair.masters, 1), OutlineOf(free.masters, 1));
  EXPECT_EQ(report.met, 0);  // It ends within, and the other never came near.
}

TEST(SolverConstraintTest, WeightZeroIsNoConstraint) {
  Hair hair = fixtures::HairOn(fixtures::Head(), 200, 20, 0.01, 200);
  Hair free = hair;
  Select(&hair,
         {{Kind::kPoint, {Vector3d(0, 0, -0.15)}, 0.02, 0},
          {Kind::kTrajectory, {Vector3d(0, 0, -0.15), Vector3d(0, -0.1, -0.15)}, 0.02, 0},
          {Kind::kDirection, {Vector3d(0, 0, -0.15), Vector3d(0, 0.2, 0)}, 0.1, 0}},
         150);
  Solve(&hair);
  Solve(&free);
  EXPECT_EQ(hair.masters.outline, free.masters.outline);
}

TEST(SolverConstraintTest, OneSegmentIsTheClosedForm) {
  for (const double w : {0.1, 0.5, 0.9}) {
    Hair hair = fixtures::WispAt({0, 0, 0}, Vector3d::UnitX(), 1, 0.01);
    hair.input.bending_stiffness = 0.8;
    Select(&hair, {{Kind::kPoint, {Vector3d(0, 0, 1)}, 0.01, w}}, 1);
    Solve(&hair);
    const Vector3d sum = (1 - w) * Vector3d(0.8, -1, 0) + w * 1.8 * Vector3d::UnitZ();
    EXPECT_LT((hair.masters.outline[1].cast<double>() - 0.01 * sum.normalized()).norm(), 1e-8);
  }
}

TEST(SolverConstraintTest, WorkersMakeTheSameBits) {
  Hair one = fixtures::HairOn(fixtures::Head(), 200, 40, 0.01, 200);
  const Vector3d tie(0, 0.02, -0.13);
  Select(&one,
         {{Kind::kPoint, {tie}, 0.02, 0.9},
          {Kind::kTrajectory, {tie, tie - Vector3d(0, 0.1, 0.05)}, 0.02, 0.9}},
         150);
  Hair four = one;
  Solve(&one, 1);
  Solve(&four, 4);
  EXPECT_EQ(one.masters.outline, four.masters.outline);
}

}  // namespace
}  // namespace mane::styling
