// Properties of staying:
//   buckling      a column stays below Greenhill's limit and falls above it
//   growth        what leaves too slowly to be far in that time does not stay
//   inverse       a held shape is one that stays

#include "rod/stays.h"

#include <gtest/gtest.h>

#include <vector>

#include "rod/inverse_statics.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::kGravity;
using fixtures::kL;
using fixtures::Upright;

constexpr double kGreenhill = 7.837347;

// A column of a gravito-bending number, left alone; its angles at the end.
StayReport LeaveColumn(double number, std::vector<Vector3d>* theta) {
  theta->assign(10, Vector3d::Zero());
  return Stays(fixtures::HeavyStrand(number, 10), Upright(), kGravity, kLongestStep, *theta);
}

TEST(StaysTest, AColumnStaysBelowGreenhillsLimitAndFallsAboveIt) {
  std::vector<Vector3d> theta;
  for (const double number : {0.1, 1.0, 4.0, 7.0}) {
    SCOPED_TRACE(number);
    const StayReport report = LeaveColumn(number, &theta);
    EXPECT_TRUE(report.stays);
    EXPECT_LT(report.farthest, 1e-4 * kL);
  }
  for (const double number : {12.0, 50.0, 200.0}) {
    SCOPED_TRACE(number);
    const StayReport report = LeaveColumn(number, &theta);
    EXPECT_FALSE(report.stays);
    EXPECT_GT(report.farthest, 0.1 * kL);
    EXPECT_GE(report.farthest, report.tip);
    EXPECT_GT(fixtures::Largest(theta), 0.01);
  }
}

TEST(StaysTest, WhatGrowsDoesNotStayHoweverNearItIs) {
  std::vector<Vector3d> theta;
  const StayReport report = LeaveColumn(1.02 * kGreenhill, &theta);
  EXPECT_FALSE(report.stays);
  EXPECT_LT(report.farthest, 1e-3 * kL);
}

TEST(StaysTest, SameArgumentsSameBits) {
  std::vector<Vector3d> a, b;
  EXPECT_EQ(LeaveColumn(50, &a).farthest, LeaveColumn(50, &b).farthest);
  EXPECT_EQ(a, b);
}

TEST(StaysTest, HeldShapesStay) {
  fixtures::Random random(911);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    Strand strand = fixtures::MakeStrand(fixtures::AppendixB()[i % 4], kL, 10);
    const math::Pose clamp = random.Pose();
    std::vector<Vector3d> theta = random.Vectors(10, 1);
    HoldOptions options{1, 1e3, 0.02, 0.02};
    options.longest_step = kLongestStep;
    const HoldReport report = HoldShape(strand, clamp, kGravity, theta, options);
    EXPECT_TRUE(report.held);
    EXPECT_TRUE(Stays(strand, clamp, kGravity, kLongestStep, theta).stays);
  }
}

}  // namespace
}  // namespace mane::rod
