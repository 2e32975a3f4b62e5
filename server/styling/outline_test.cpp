// Laws of the decomposition into outline and details:
//   identity   c_i + F_i delta_i lies on the curve, and follows it; outline steps are equal
//   axis       that of a helix is straight, wherever it ends, and its details have the radius
//   smooth     straight lines, arcs and an S have details of exactly 0
//   frames     x along the segment, no turn about it

#include "styling/outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "math/random.h"
#include "styling/spline.h"

namespace mane::styling {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
constexpr double kTurn = 2 * std::numbers::pi;

const Quaterniond kAnyTurn = Quaterniond(0.3, -0.5, 0.7, 0.1).normalized();

std::vector<Vector3d> Helix(double radius, double pitch, double turns) {
  std::vector<Vector3d> points;
  const int n = static_cast<int>(64 * turns);
  for (int i = 0; i <= n; ++i) {
    const double x = turns * i / n;
    points.push_back(
        kAnyTurn * Vector3d(pitch * x, radius * std::cos(kTurn * x), radius * std::sin(kTurn * x)));
  }
  return points;
}

// An arc of `angle`, 0.2 m long; the second half bent back where `s_shaped`.
std::vector<Vector3d> Arc(double angle, bool s_shaped) {
  std::vector<Vector3d> points{Vector3d::Zero()};
  for (int i = 0; i < 300; ++i) {
    const double x = (i + 0.5) / 300;
    const double heading = angle * (s_shaped && x > 0.5 ? 1 - x : x);
    points.push_back(points.back() +
                     0.2 / 300 * (kAnyTurn * Vector3d(std::cos(heading), std::sin(heading), 0)));
  }
  return points;
}

double DistanceTo(const std::vector<Vector3d>& polyline, const Vector3d& p) {
  double nearest = 1e9;
  for (size_t i = 0; i + 1 < polyline.size(); ++i) {
    const Vector3d d = polyline[i + 1] - polyline[i];
    const double t = std::clamp(d.dot(p - polyline[i]) / d.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (polyline[i] + t * d - p).norm());
  }
  return nearest;
}

TEST(OutlineTest, OutlineAndDetailsMakeTheCurve) {
  std::vector<Vector3d> irregular = Helix(0.005, 0.02, 9.3);
  math::RandomStream random(1, 1);
  for (Vector3d& p : irregular) p += 1e-4 * Vector3d(random.Normal(), random.Normal(), 0);
  for (const auto& curve : {Helix(0.005, 0.02, 9.3), Arc(2, false), irregular}) {
    const Decomposition parts = Decompose(curve, 0.003);
    ASSERT_GT(parts.points(), 20);
    // Resampling to 1024 or more cuts the corners of a coarse polyline: 5 mm (turn / 128)^2 / 2.
    for (int i = 0; i < parts.points(); ++i) {
      const Vector3d p = parts.outline[i] + parts.frames[i] * parts.details[i];
      EXPECT_LT(DistanceTo(curve, p), 1e-4);
      if (i == 0) continue;
      EXPECT_NEAR((parts.outline[i] - parts.outline[i - 1]).norm(), 0.003, 1e-12);
    }
    EXPECT_LT((parts.outline[0] + parts.frames[0] * parts.details[0] - curve.front()).norm(),
              1e-12);
  }
}

TEST(OutlineTest, AHelixHasAStraightAxisAndItsRadius) {
  for (double radius : {0.0005, 0.004, 0.01}) {
    for (double turns : {2.2, 5.0, 11.7}) {
      const Decomposition parts = Decompose(Helix(radius, 0.02, turns), 0.004);
      SCOPED_TRACE(testing::Message() << radius << " m, " << turns << " turns");
      EXPECT_NEAR(parts.structure, 0.02, 2e-4);
      const Vector3d axis = kAnyTurn * Vector3d::UnitX();
      for (int i = 0; i < parts.points(); ++i) {
        // Of few turns the line of regression takes a part with it, and the window is off by that.
        const double tolerance = 0.1 / turns * radius;
        EXPECT_LT(parts.outline[i].cross(axis).norm(), tolerance);
        EXPECT_NEAR(parts.details[i].norm(), radius, tolerance);
        EXPECT_LT(std::abs(parts.details[i].x()), tolerance);
      }
      EXPECT_EQ(parts.points(), static_cast<int>(turns * 5 + 0.05) + 1);
    }
  }
}

TEST(OutlineTest, WhatIsSmoothHasNoDetails) {
  std::vector<std::vector<Vector3d>> curves{
      {Vector3d(0.1, 0.2, 0.3), Vector3d(0.17, 0.25, 0.21), Vector3d(0.45, 0.45, -0.15)}};
  for (double degrees : {5.0, 30.0, 90.0, 180.0, 270.0}) {
    curves.push_back(Arc(degrees / 360 * kTurn, false));
    curves.push_back(Arc(degrees / 360 * kTurn, true));
  }
  for (const auto& curve : curves) {
    const Decomposition parts = Decompose(curve, 0.01);
    EXPECT_EQ(parts.structure, 0);
    EXPECT_GE(parts.points(), 14);
    for (const Vector3d& delta : parts.details) EXPECT_EQ(delta, Vector3d::Zero());
  }
}

TEST(OutlineTest, AStraightStrandHasAllItsSegments) {
  const std::vector<Vector3d> curve{Vector3d::Zero(), Vector3d(0, 0.03, 0), Vector3d(0, 0.2, 0)};
  EXPECT_EQ(Decompose(curve, 0.01).points(), 21);
}

TEST(OutlineTest, WavesOnABendAreTheDetails) {
  // Waves of 2 mm along an arc of a right angle and 30 cm: its axis is the arc.
  const double R = 0.3 / (kTurn / 4);
  std::vector<Vector3d> curve;
  for (int i = 0; i <= 1000; ++i) {
    const double x = i / 1000.0, angle = x * kTurn / 4;
    curve.push_back((R + 0.002 * std::sin(10 * kTurn * x)) *
                    Vector3d(std::sin(angle), std::cos(angle), 0));
  }
  const Decomposition parts = Decompose(curve, 0.005);
  EXPECT_NEAR(parts.structure, 0.03, 0.001);
  for (int i = 0; i < parts.points(); ++i) {
    // The mean over a window w of an arc lies w^2 / (24 R) = 0.2 mm inside of it; straight on over
    // half a window at the ends, w^2 / (8 R) = 0.6 mm outside.
    EXPECT_NEAR(parts.outline[i].norm(), R, 8e-4);
    EXPECT_LT(parts.details[i].norm(), 0.0028);
  }
}

TEST(OutlineTest, RandomTurnsHaveAStructureToo) {
  math::RandomStream random(7, 0);
  std::vector<Vector3d> knots;
  for (int i = 0; i < 80; ++i) {
    knots.emplace_back(0.005 * i, 0.002 * random.Normal(), 0.002 * random.Normal());
  }
  const auto curve = Spline<double>(knots).Polyline(16);
  const Decomposition parts = Decompose(curve, 0.002);
  EXPECT_GT(parts.structure, 0.004);
  EXPECT_LT(parts.structure, 0.04);
  double square = 0;
  for (const Vector3d& delta : parts.details) square += delta.squaredNorm() / parts.points();
  EXPECT_GT(std::sqrt(square), 0.001);
}

TEST(OutlineTest, FramesTurnAlongWithTheOutlineAndNoMore) {
  const Decomposition parts = Decompose(Arc(3, false), 0.01);
  const int last = parts.points() - 1;
  const Vector3d n = kAnyTurn * Vector3d::UnitZ();
  for (int i = 0; i < last; ++i) {
    const Vector3d along = (parts.outline[i + 1] - parts.outline[i]).normalized();
    EXPECT_LT((parts.frames[i] * Vector3d::UnitX() - along).norm(), 1e-12);
    // The arc's normal is still what it was in the first frame.
    EXPECT_LT((parts.frames[i].conjugate() * n - parts.frames[0].conjugate() * n).norm(), 1e-12);
  }
  EXPECT_EQ(parts.frames[last].coeffs(), parts.frames[last - 1].coeffs());
}

}  // namespace
}  // namespace mane::styling
