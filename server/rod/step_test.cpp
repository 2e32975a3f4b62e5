// Properties of one time step:
//   oracle         equals the dense minimisation of the same quadratic form (rod.md, S3)
//   physics        from rest it accelerates by M^-1 f as dt -> 0
//   symmetry       turned, moved or Galilean-boosted surroundings give the same angles
//   determinism    same input, same bits, whatever the scratch was used for
//   economy        a warm step does not allocate
//   failure        reports what is not finite

#include "rod/step.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/check_failure.h"
#include "base/test_allocations.h"
#include "rod/test_oracle.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Difference;
using fixtures::Largest;
using fixtures::Random;
using fixtures::State;

TEST(StepTest, EqualsTheDenseMinimisation) {
  Random random(4711);
  StepScratch scratch;
  for (const int N : {1, 2, 3, 5, 10}) {
    for (const double dt : {1e-3, 1.0 / 120, 1.0 / 30, 0.1}) {
      for (int i = 0; i < 3; ++i) {
        SCOPED_TRACE(testing::Message() << "N=" << N << " dt=" << dt << " i=" << i);
        const Strand strand = random.UnevenStrand(N, 0.2, 1.5);
        const State start = random.AnyState(strand, 0.5, 5, 1);
        const ClampMotion clamp = random.AnyMotion(dt);
        const Surroundings air = random.AnyAir();
        State mine = start, dense = start;
        ASSERT_TRUE(Step(strand, clamp, air, mine.View(), scratch));
        oracle::DenseStep(strand, clamp, air, dense.View());
        // The quadratic form of a strand is conditioned like 1e5 at these steps (twist has next to
        // no inertia), which multiplies the rounding.
        const double rates = Largest(dense.rate), speeds = Largest(dense.velocity);
        EXPECT_LT(Difference(mine.rate, dense.rate), 1e-9 * rates);
        EXPECT_LT(Difference(mine.theta, dense.theta), 1e-9 * dt * rates + 1e-14);
        EXPECT_LT(Difference(mine.velocity, dense.velocity), 1e-9 * speeds);
      }
    }
  }
}

TEST(StepTest, AcceleratesFromRestByTheInverseMassTimesForce) {
  Random random(12);
  for (const int N : {1, 2, 4}) {
    Strand strand = random.UnevenStrand(N, 0.2, 2);
    strand.internal_friction = 0;
    strand.air_drag = 0;
    State start = random.AnyState(strand, 0.3, 0, 0);
    const math::Pose clamp = random.Pose();
    const Surroundings air;
    const oracle::Rod rod(strand);
    const oracle::Vector theta = oracle::Stack(start.theta);
    const oracle::Frame frame = oracle::ToFrame(clamp);
    const oracle::Vector force = -rod.Gradient(frame, air.gravity.cast<oracle::Real>(), theta);
    const oracle::Vector acceleration = rod.StepMass(frame, theta).ldlt().solve(force);
    double error[2];
    for (int i = 0; i < 2; ++i) {
      const double dt = i == 0 ? 2e-6 : 1e-6;
      State state = start;
      StepScratch scratch;
      ASSERT_TRUE(Step(strand, {clamp, clamp, dt}, air, state.View(), scratch));
      // The rate is that at kTheta dt.
      const oracle::Vector mine = oracle::Stack(state.rate) / (kTheta * dt);
      error[i] = static_cast<double>((mine - acceleration).norm() / acceleration.norm());
    }
    // (M + h^2 K) v = h f: the difference is of second order in dt.
    EXPECT_LT(error[1], 1e-3) << N;
    EXPECT_NEAR(error[0] / error[1], 4, 0.1) << N;
  }
}

TEST(StepTest, TurningEverythingTurnsTheAnswer) {
  Random random(13);
  const Strand strand = random.UnevenStrand(6, 0.2, 1);
  const math::Pose turn = random.Pose();
  State here = random.AnyState(strand, 0.3, 5, 1), there = here;
  ClampMotion clamp = random.AnyMotion(1.0 / 60);
  Surroundings air = random.AnyAir();
  StepScratch scratch;
  ASSERT_TRUE(Step(strand, clamp, air, here.View(), scratch));
  clamp = {turn * clamp.begin, turn * clamp.end, clamp.dt};
  air.gravity = turn.q * air.gravity;
  air.wind = turn.q * air.wind;
  for (Vector3d& u : there.velocity) u = turn.q * u;
  ASSERT_TRUE(Step(strand, clamp, air, there.View(), scratch));
  for (Vector3d& u : there.velocity) u = turn.q.conjugate() * u;
  EXPECT_LT(Difference(here.rate, there.rate), 1e-10 * Largest(here.rate));
  EXPECT_LT(Difference(here.velocity, there.velocity), 1e-10 * Largest(here.velocity));
}

TEST(StepTest, GalileanBoostChangesNoAngle) {
  Random random(14);
  const Strand strand = random.UnevenStrand(6, 0.2, 1);
  const Vector3d boost(3, -1, 2);
  State slow = random.AnyState(strand, 0.3, 5, 1), fast = slow;
  ClampMotion clamp = random.AnyMotion(1.0 / 60);
  Surroundings air = random.AnyAir();
  StepScratch scratch;
  ASSERT_TRUE(Step(strand, clamp, air, slow.View(), scratch));
  clamp.end.p += clamp.dt * boost;
  air.wind += boost;
  for (Vector3d& u : fast.velocity) u += boost;
  ASSERT_TRUE(Step(strand, clamp, air, fast.View(), scratch));
  for (Vector3d& u : fast.velocity) u -= boost;
  // Drag sums over Gauss points and wind by centres of mass: alike to 1e-7 for these gentle
  // elements.
  EXPECT_LT(Difference(slow.rate, fast.rate), 1e-6 * Largest(slow.rate));
  EXPECT_LT(Difference(slow.velocity, fast.velocity), 1e-6 * Largest(slow.velocity));
}

bool SameBits(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

TEST(StepTest, SameInputGivesTheSameBitsWhateverTheScratch) {
  Random random(15);
  StepScratch used;
  for (int i = 0; i < 20; ++i) {
    const int N = 1 + i % 7;
    const Strand strand = random.UnevenStrand(N, 0.2, 1);
    const State start = random.AnyState(strand, 0.3, 5, 1);
    const ClampMotion clamp = random.AnyMotion(1.0 / 60);
    const Surroundings air = random.AnyAir();
    State a = start, b = start;
    StepScratch fresh;
    for (int step = 0; step < 30; ++step) {
      ASSERT_TRUE(Step(strand, clamp, air, a.View(), used));
      ASSERT_TRUE(Step(strand, clamp, air, b.View(), fresh));
    }
    EXPECT_TRUE(SameBits(a.theta, b.theta));
    EXPECT_TRUE(SameBits(a.rate, b.rate));
    EXPECT_TRUE(SameBits(a.velocity, b.velocity));
  }
}

TEST(StepTest, WarmStepsDoNotAllocate) {
  Random random(16);
  const Strand strand = random.UnevenStrand(10, 0.2, 1), shorter = random.UnevenStrand(4, 0.2, 1);
  State state(strand), other(shorter);
  const ClampMotion clamp = random.AnyMotion(1.0 / 60);
  const Surroundings air = random.AnyAir();
  StepScratch scratch;
  ASSERT_TRUE(Step(strand, clamp, air, state.View(), scratch));
  long warm = -1, cold = -1;
  {
    const mane::fixtures::AllocationCount allocations;
    for (int i = 0; i < 10; ++i) {
      (void)Step(strand, clamp, air, state.View(), scratch);
      (void)Step(shorter, clamp, air, other.View(), scratch);
    }
    warm = allocations.count();
  }
  EXPECT_EQ(warm, 0);
  {  // The counter counts: a cold step does allocate.
    const mane::fixtures::AllocationCount allocations;
    StepScratch fresh;
    (void)Step(strand, clamp, air, state.View(), fresh);
    cold = allocations.count();
  }
  EXPECT_GT(cold, 0);
}

TEST(StepTest, ReportsWhatIsNotFinite) {
  Random random(18);
  const Strand strand = random.UnevenStrand(4, 0.2, 1);
  const math::Pose clamp;
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf}) {
    for (int i = 0; i < 4; ++i) {
      StepScratch scratch;
      State state(strand);
      Surroundings air;
      ClampMotion motion{clamp, clamp, 1.0 / 60};
      ASSERT_TRUE(Step(strand, motion, air, state.View(), scratch));
      if (i == 0) state.theta[2].y() = bad;
      if (i == 1) state.velocity[5].z() = bad;
      if (i == 2) air.gravity.x() = bad;
      if (i == 3) motion.end.p.y() = bad;
      EXPECT_FALSE(Step(strand, motion, air, state.View(), scratch)) << bad << " " << i;
      // A scratch that saw it harms no other strand.
      State healthy(strand);
      EXPECT_TRUE(Step(strand, {clamp, clamp, 1.0 / 60}, {}, healthy.View(), scratch));
    }
  }
}

TEST(StepTest, RefusesAStepOfNoTimeAndTheWrongSize) {
  const Strand strand = fixtures::HeavyStrand(10, 3), longer = fixtures::HeavyStrand(10, 4);
  State state(strand);
  StepScratch scratch;
  EXPECT_THROW((void)Step(strand, {{}, {}, 0}, {}, state.View(), scratch), base::CheckFailure);
  EXPECT_THROW((void)Step(longer, {{}, {}, 0.01}, {}, state.View(), scratch), base::CheckFailure);
}

TEST(PointLoadTest, DragAtTheGaussPointsIsAirDrag) {
  Random random(31);
  for (const int N : {1, 2, 5}) {
    Strand loaded = fixtures::HeavyStrand(1e12, N);  // Drag multiplies rotary inertia, too (S12).
    for (Vector3d& natural : loaded.natural) natural = random.Vector(20);
    Strand dragged = loaded;
    const double dt = 1.0 / 60, rate = 8;
    dragged.air_drag = rate * dragged.linear_density;
    State a = random.AnyState(loaded, 1, 5, 1), b = a;
    const math::Pose clamp = random.Pose();
    std::vector<PointLoad> loads;
    for (int Q = 0; Q < N; ++Q) {
      for (int g = 0; g < kGaussPoints; ++g) {
        const double mass = loaded.linear_density * loaded.length[Q] * kGauss.weights[g];
        loads.push_back({Q, kGauss.nodes[g],
                         kTheta * dt * rate * mass * Eigen::Matrix3d::Identity(),
                         Vector3d::Zero()});
      }
    }
    StepScratch scratch;
    ASSERT_TRUE(Step(loaded, {clamp, clamp, dt}, {}, loads, a.View(), scratch));
    ASSERT_TRUE(Step(dragged, {clamp, clamp, dt}, {}, b.View(), scratch));
    EXPECT_LT(Difference(a.theta, b.theta), 1e-9) << N;
    EXPECT_LT(Difference(a.velocity, b.velocity), 1e-9) << N;
  }
}

TEST(PointLoadTest, AHeavyLoadTakesItsPointAlong) {
  Random random(32);
  for (const int N : {1, 3, 6}) {
    const Strand strand = random.UnevenStrand(N, 0.2, 1);
    State state = random.AnyState(strand, 1, 2, 1);
    const ClampMotion clamp = random.AnyMotion(1.0 / 60);
    const ArcPosition where{N - 1, 0.6};
    const Vector3d wanted = random.Vector(1);
    const double heavy = 1e4 * strand.linear_density * strand.TotalLength();
    const PointLoad load{where.element, where.fraction, heavy * Eigen::Matrix3d::Identity(),
                         heavy * wanted};
    // The point at the linearisation (S2), and how it moves with the clamp and with rates.
    std::vector<Vector3d> ahead = state.theta;
    for (int Q = 0; Q < N; ++Q) ahead[Q] += kTheta * clamp.dt * state.rate[Q];
    const math::Pose middle = math::Interpolate(clamp.begin, clamp.end, kTheta);
    const PointKinematics point = PointAt(strand, middle, ahead, where);
    const Vector3d spin = math::RotationVector(clamp.end.q * clamp.begin.q.conjugate()) / clamp.dt;
    const Vector3d carried =
        (clamp.end.p - clamp.begin.p) / clamp.dt + spin.cross(point.r - middle.p);
    StepScratch scratch;
    ASSERT_TRUE(Step(strand, clamp, {}, {&load, 1}, state.View(), scratch));
    Eigen::VectorXd rate(3 * N);
    for (int Q = 0; Q < N; ++Q) rate.segment<3>(3 * Q) = state.rate[Q];
    // One element bends and twists where three cannot be asked of it at once.
    if (N > 1) {
      EXPECT_LT((carried + point.J * rate - wanted).norm(), 0.02) << N;
    }
  }
}

}  // namespace
}  // namespace mane::rod
