// Violent motion leaves every strand finite, of its length, and at sane speeds, at 1/30 s without
// sub-steps, for all hair types of [SH06] Appendix B; so do longer steps without any damping.

#include <gtest/gtest.h>

#include <cmath>

#include "rod/chain.h"
#include "rod/step.h"
#include "rod/test_motions.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Motion;
using fixtures::Shake;
using fixtures::SnapTurn;
using fixtures::Spin;
using fixtures::State;
using fixtures::Teleport;

// Checks all inter-point distances of a polyline along the strand against arc length.
void ExpectOfItsLength(const Strand& strand, const math::Pose& clamp, const State& state) {
  constexpr int kPoints = 8;  // In each element.
  const std::vector<ElementFrame> frames = ElementFrames(strand, clamp, state.theta);
  double length = 0;
  Vector3d previous = clamp.p;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    const double l = strand.length[Q];
    for (int i = 1; i <= kPoints; ++i) {
      const ElementPoint point = PointOnElement(state.theta[Q], static_cast<double>(i) / kPoints);
      const Vector3d r = frames[Q].r + l * (frames[Q].R * point.p);
      ASSERT_LE((r - previous).norm(), l / kPoints * (1 + 1e-9));
      length += (r - previous).norm();
      previous = r;
    }
  }
  ASSERT_LE(length, strand.TotalLength() * (1 + 1e-9));
}

double Fastest(const std::vector<Vector3d>& velocity) {
  double fastest = 0;
  for (const Vector3d& u : velocity) fastest = std::max(fastest, u.norm());
  return fastest;
}

// Runs `steps` steps and returns the largest speed of any point over the clamp's largest.
double RelativeSpeed(const Strand& strand, const Motion& motion, const Surroundings& air, double dt,
                     int steps) {
  State state(strand);
  StepScratch scratch;
  double fastest = 0, clamp_fastest = std::sqrt(2 * 9.81 * strand.TotalLength());
  for (int i = 0; i < steps; ++i) {
    const ClampMotion clamp{motion(i, dt), motion(i + 1, dt), dt};
    EXPECT_TRUE(Step(strand, clamp, air, state.View(), scratch)) << i;
    const double turn = math::RotationVector(clamp.end.q * clamp.begin.q.conjugate()).norm();
    clamp_fastest = std::max(clamp_fastest, (clamp.end.p - clamp.begin.p).norm() / dt +
                                                turn / dt * strand.TotalLength());
    fastest = std::max(fastest, Fastest(state.velocity));
    if (i % 10 == 0 || i + 1 == steps) ExpectOfItsLength(strand, clamp.end, state);
    if (::testing::Test::HasFailure()) break;
  }
  return fastest / clamp_fastest;
}

// A strand flicked like a whip outruns its root, but only by so much; without damping, energy comes
// in at random until the scheme's own damping takes it out again.
constexpr double kWhip = 5, kUndampedWhip = 15;

class BoundedTest : public ::testing::TestWithParam<int> {
 protected:
  void ExpectBounded(const Motion& motion, double dt, int steps, bool damped) {
    const fixtures::Hair& hair = fixtures::AppendixB()[GetParam()];
    for (const double length : {0.1, 0.2, 0.3}) {
      for (const int N : {5, 10}) {
        SCOPED_TRACE(::testing::Message() << hair.name << " L=" << length << " N=" << N);
        Strand strand = fixtures::MakeStrand(hair, length, N);
        if (!damped) {
          strand.internal_friction = 0;
          strand.air_drag = 0;
        }
        EXPECT_LT(RelativeSpeed(strand, motion, {}, dt, steps), damped ? kWhip : kUndampedWhip);
      }
    }
  }
};

INSTANTIATE_TEST_SUITE_P(AppendixB, BoundedTest, ::testing::Range(0, 4),
                         [](const auto& hair) { return fixtures::AppendixB()[hair.param].name; });

TEST_P(BoundedTest, Shakes) { ExpectBounded(Shake, 1.0 / 30, 900, true); }
TEST_P(BoundedTest, SnapTurns) { ExpectBounded(SnapTurn, 1.0 / 30, 900, true); }
TEST_P(BoundedTest, Teleports) { ExpectBounded(Teleport, 1.0 / 30, 900, true); }
TEST_P(BoundedTest, UndampedShakesAtATenthOfASecond) { ExpectBounded(Shake, 0.1, 300, false); }
TEST_P(BoundedTest, UndampedSpinsAtATenthOfASecond) { ExpectBounded(Spin, 0.1, 300, false); }

TEST_P(BoundedTest, CalmsDownAfterTheStorm) {
  const fixtures::Hair& hair = fixtures::AppendixB()[GetParam()];
  const Strand strand = fixtures::MakeStrand(hair, 0.2, 5);
  State state(strand);
  StepScratch scratch;
  const double dt = 1.0 / 30;
  for (int i = 0; i < 90; ++i) {
    ASSERT_TRUE(
        Step(strand, {Teleport(i, dt), Teleport(i + 1, dt), dt}, {}, state.View(), scratch));
  }
  const math::Pose still = Teleport(90, dt);
  for (int i = 0; i < 1800; ++i) {
    ASSERT_TRUE(Step(strand, {still, still, dt}, {}, state.View(), scratch));
  }
  // A minute of drag at about nu / (2 rho S) = 0.5 per second.
  EXPECT_LT(Fastest(state.velocity), 1e-3);
}

}  // namespace
}  // namespace mane::rod
