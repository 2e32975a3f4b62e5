// Properties of one time step of a wound strand:
//   selection      which strands are wound
//   oracle         equals the dense minimisation of S3 with brute-force kinematics
//   physics        from rest it accelerates by M^-1 f as dt -> 0
//   moving frame   an evenly accelerated clamp is weight; turning all turns the answer
//   economy        a warm step does not allocate; same input, same bits
//   largest turn   S11 caps what an element turns by
//   failure        reports what is not finite

#include "rod/wound.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/check_failure.h"
#include "base/test_allocations.h"
#include "rod/test_wound.h"
#include "rod/test_wound_oracle.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::AnyWound;
using fixtures::Random;
using fixtures::WoundOwned;

ClampMotion AnyMotion(Random& random, double dt) {
  const math::Pose begin = random.Pose();
  const math::Pose end{begin.p + random.Vector(0.01),
                       math::FromRotationVector(random.Vector(0.5)) * begin.q};
  return {begin, end, dt};
}

Surroundings AnyAir(Random& random) {
  Surroundings air;
  air.gravity = random.Vector(10);
  air.wind = random.Vector(3);
  air.internal_friction_scale = random.Uniform(0, 2);
  air.air_drag_scale = random.Uniform(0, 20);
  return air;
}

template <class V>
double Largest(const std::vector<V>& vectors) {
  double largest = 0;
  for (const V& v : vectors) largest = std::max(largest, v.norm());
  return largest;
}

template <class V>
double Difference(const std::vector<V>& a, const std::vector<V>& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

template <class V>
bool SameBits(const std::vector<V>& a, const std::vector<V>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(V)) == 0;
}

TEST(WoundTest, StrandsThatWindOftenAreWound) {
  const std::vector<fixtures::Hair>& hairs = fixtures::AppendixB();
  const auto wound = [&](int hair, double length, int N) {
    return IsWound(fixtures::MakeStrand(hairs[hair], length, N));
  };
  for (const int N : {5, 10}) {
    for (const double length : {0.1, 0.2, 0.3}) {
      EXPECT_FALSE(wound(0, length, N)) << length;              // smooth: no coil
      EXPECT_FALSE(wound(1, length, N)) << length;              // wavy: 1.6 to 4.8 turns
      EXPECT_EQ(wound(2, length, N), length > 0.15) << length;  // curly: 2.7, 5.4, 8.0
      EXPECT_TRUE(wound(3, length, N)) << length;               // fuzzy: 30 to 90
    }
  }
  EXPECT_FALSE(wound(2, 0.3, 20));  // Two elements a turn and more follow the coil.
  EXPECT_FALSE(wound(3, 0.1, 80));
  EXPECT_NEAR(NaturalTurns(fixtures::MakeStrand(hairs[2], 0.2, 5)), 5.35, 0.01);
  Strand mixed = fixtures::MakeStrand(hairs[3], 0.2, 5);
  mixed.natural[2] *= 1.1;
  EXPECT_TRUE(IsWound(mixed));
  EXPECT_NEAR(NaturalTurns(mixed), 1.02 * NaturalTurns(fixtures::MakeStrand(hairs[3], 0.2, 5)),
              1e-12);
  mixed.natural[2].x() *= 0.2;  // Its coil's axis stands at more than half a radian to the others.
  EXPECT_FALSE(IsWound(mixed));
  mixed.natural[2] = {1000, 0, 0};
  EXPECT_FALSE(IsWound(mixed));
  EXPECT_THROW((void)MakeWound(mixed), base::CheckFailure);
  EXPECT_THROW((void)MakeWound(fixtures::MakeStrand(hairs[0], 0.2, 5)), base::CheckFailure);
}

TEST(WoundTest, EqualsTheDenseMinimisation) {
  Random random(4712);
  WoundScratch scratch;
  for (const int N : {1, 2, 5, 10}) {
    for (const double dt : {1e-3, 1.0 / 120, 1.0 / 30, 0.1}) {
      for (const double turns : {3.0, 8.0, 40.0}) {
        SCOPED_TRACE(testing::Message() << "N=" << N << " dt=" << dt << " turns=" << turns);
        const WoundStrand wound = AnyWound(random, N, 0.2, turns);
        const WoundOwned start(wound, random, 0.5, 5, 1);
        const ClampMotion clamp = AnyMotion(random, dt);
        const Surroundings air = AnyAir(random);
        WoundOwned mine = start, dense = start;
        ASSERT_TRUE(Step(wound, clamp, air, mine.View(), scratch));
        oracle::DenseStep(wound.strand, clamp, air, dense.View());
        const double rates = Largest(dense.rate), speeds = Largest(dense.velocity);
        EXPECT_LT(Difference(mine.rate, dense.rate), 1e-9 * rates);
        EXPECT_LT(Difference(mine.x, dense.x), 1e-9 * dt * rates + 1e-14);
        EXPECT_LT(Difference(mine.velocity, dense.velocity), 1e-9 * speeds);
      }
    }
  }
}

TEST(WoundTest, AcceleratesFromRestByTheInverseMassTimesForce) {
  Random random(12);
  for (const int N : {1, 2, 4}) {
    WoundStrand wound = AnyWound(random, N, 0.2, 6);
    wound.strand.internal_friction = 0;
    wound.strand.air_drag = 0;
    const WoundOwned start(wound, random, 0.3, 0, 0);
    const math::Pose clamp = random.Pose();
    const Surroundings air;
    const oracle::WoundRod rod(wound.strand);
    const oracle::Vector x = oracle::Stack(start.x);
    const oracle::Frame frame = oracle::ToFrame(clamp);
    const oracle::Vector force = -rod.Stiffness() * (x - rod.Natural()) -
                                 rod.GravityGradient(frame, air.gravity.cast<oracle::Real>(), x);
    const std::vector<oracle::Matrix3X> J = rod.Jacobians(frame, x);
    const oracle::Vector masses = rod.Masses();
    oracle::Matrix M = oracle::Matrix::Zero(4 * N, 4 * N);
    for (size_t k = 0; k < J.size(); ++k) M += masses[k] * J[k].transpose() * J[k];
    const oracle::Vector acceleration = M.ldlt().solve(force);
    double error[2];
    for (int i = 0; i < 2; ++i) {
      const double dt = i == 0 ? 2e-6 : 1e-6;
      WoundOwned state = start;
      WoundScratch scratch;
      ASSERT_TRUE(Step(wound, {clamp, clamp, dt}, air, state.View(), scratch));
      const oracle::Vector mine = oracle::Stack(state.rate) / (kTheta * dt);
      error[i] = static_cast<double>((mine - acceleration).norm() / acceleration.norm());
    }
    // (M + h^2 K) v = h f: the difference is of second order in dt.
    EXPECT_LT(error[1], 1e-2) << N;
    EXPECT_NEAR(error[0] / error[1], 4, 0.1) << N;
  }
}

// Largest difference of the unknowns between a clamp that accelerates evenly and a fixed one under
// the weight g - a, over their largest value, in half a second of steps of `dt`.
double DifferenceOfMovingFrames(double turns, double dt) {
  Random random(31);
  const WoundStrand wound = AnyWound(random, 8, 0.2, turns, 0);
  const Vector3d a(4, -3, 6);
  const math::Pose root{{0.1, 0.2, 0.3}, random.Rotation()};
  WoundOwned fixed(wound), moving(wound);
  for (Vector3d& u : moving.velocity) u += a * dt * (0.5 - kTheta);  // As StepMotionTest does.
  Surroundings still, carried;
  still.gravity -= a;
  WoundScratch scratch;
  double largest = 0, motion_of_all = 0;
  for (int i = 0; i * dt < 0.5; ++i) {
    ClampMotion motion{root, root, dt};
    EXPECT_TRUE(Step(wound, motion, still, fixed.View(), scratch));
    motion.begin.p += 0.5 * a * (i * dt) * (i * dt);
    motion.end.p += 0.5 * a * ((i + 1) * dt) * ((i + 1) * dt);
    carried.wind = (motion.end.p - motion.begin.p) / dt;  // The air rides along.
    EXPECT_TRUE(Step(wound, motion, carried, moving.View(), scratch));
    largest = std::max(largest, Difference(fixed.x, moving.x));
    motion_of_all = std::max(motion_of_all, Largest(fixed.x));
  }
  EXPECT_GT(motion_of_all, 0.1);
  return largest / motion_of_all;
}

TEST(WoundTest, EvenlyAcceleratedClampIsWeight) {
  // Where the axis bends, the centre of the beads is off the axis, which carries the weight, by a
  // few percent of the radius: the difference falls with the radius. What remains is the part of
  // weight that is implicit (S9), of order dt.
  const double dt = 1.0 / 500;
  const double few = DifferenceOfMovingFrames(16, dt), many = DifferenceOfMovingFrames(64, dt);
  EXPECT_LT(few, 0.01);
  EXPECT_NEAR(few / many, 4, 0.2);
  const double coarse = DifferenceOfMovingFrames(1e5, dt);
  EXPECT_LT(coarse, 3e-4);
  EXPECT_LT(DifferenceOfMovingFrames(1e5, dt / 4), coarse / 3);
}

TEST(WoundTest, TurningEverythingTurnsTheAnswer) {
  Random random(13);
  const WoundStrand wound = AnyWound(random, 6, 0.2, 9);
  const math::Pose turn = random.Pose();
  WoundOwned here(wound, random, 0.3, 5, 1), there = here;
  ClampMotion clamp = AnyMotion(random, 1.0 / 60);
  Surroundings air = AnyAir(random);
  WoundScratch scratch;
  ASSERT_TRUE(Step(wound, clamp, air, here.View(), scratch));
  clamp = {turn * clamp.begin, turn * clamp.end, clamp.dt};
  air.gravity = turn.q * air.gravity;
  air.wind = turn.q * air.wind;
  for (Vector3d& u : there.velocity) u = turn.q * u;
  ASSERT_TRUE(Step(wound, clamp, air, there.View(), scratch));
  for (Vector3d& u : there.velocity) u = turn.q.conjugate() * u;
  EXPECT_LT(Difference(here.rate, there.rate), 1e-10 * Largest(here.rate));
  EXPECT_LT(Difference(here.velocity, there.velocity), 1e-10 * Largest(here.velocity));
}

TEST(WoundTest, SameInputGivesTheSameBitsWhateverTheScratch) {
  Random random(15);
  WoundScratch used;
  for (int i = 0; i < 20; ++i) {
    const WoundStrand wound = AnyWound(random, 1 + i % 7, 0.2, 5 + i);
    WoundOwned a(wound, random, 0.3, 5, 1), b = a;
    const ClampMotion clamp = AnyMotion(random, 1.0 / 60);
    const Surroundings air = AnyAir(random);
    WoundScratch fresh;
    for (int step = 0; step < 30; ++step) {
      ASSERT_TRUE(Step(wound, clamp, air, a.View(), used));
      ASSERT_TRUE(Step(wound, clamp, air, b.View(), fresh));
    }
    EXPECT_TRUE(SameBits(a.x, b.x));
    EXPECT_TRUE(SameBits(a.rate, b.rate));
    EXPECT_TRUE(SameBits(a.velocity, b.velocity));
  }
}

TEST(WoundTest, WarmStepsDoNotAllocate) {
  Random random(16);
  const WoundStrand wound = AnyWound(random, 10, 0.2, 12), shorter = AnyWound(random, 4, 0.2, 8);
  WoundOwned state(wound), other(shorter);
  const ClampMotion clamp = AnyMotion(random, 1.0 / 60);
  const Surroundings air = AnyAir(random);
  WoundScratch scratch;
  ASSERT_TRUE(Step(wound, clamp, air, state.View(), scratch));
  long warm = -1, cold = -1;
  {
    const mane::fixtures::AllocationCount allocations;
    for (int i = 0; i < 10; ++i) {
      (void)Step(wound, clamp, air, state.View(), scratch);
      (void)Step(shorter, clamp, air, other.View(), scratch);
    }
    warm = allocations.count();
  }
  EXPECT_EQ(warm, 0);
  {  // The counter counts: a cold step does allocate.
    const mane::fixtures::AllocationCount allocations;
    WoundScratch fresh;
    (void)Step(wound, clamp, air, state.View(), fresh);
    cold = allocations.count();
  }
  EXPECT_GT(cold, 0);
}

TEST(WoundTest, AnElementTurnsByAtMostAThousandRadians) {  // S11
  Random random(19);
  const WoundStrand wound = AnyWound(random, 4, 0.2, 8);
  WoundOwned state(wound);
  Surroundings air;
  air.gravity = {1e9, 0, 0};
  WoundScratch scratch;
  const double dt = 1.0 / 60;
  ASSERT_TRUE(Step(wound, {{}, {}, dt}, air, state.View(), scratch));
  EXPECT_NEAR(dt * Largest(state.rate), kLargestTurn, 1e-9 * kLargestTurn);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(Step(wound, {{}, {}, dt}, air, state.View(), scratch));
  EXPECT_LE(dt * Largest(state.rate), kLargestTurn * (1 + 1e-9));
}

TEST(WoundTest, ReportsWhatIsNotFinite) {
  Random random(18);
  const WoundStrand wound = AnyWound(random, 4, 0.2, 8);
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf}) {
    for (int i = 0; i < 4; ++i) {
      WoundScratch scratch;
      WoundOwned state(wound);
      Surroundings air;
      ClampMotion motion{{}, {}, 1.0 / 60};
      ASSERT_TRUE(Step(wound, motion, air, state.View(), scratch));
      if (i == 0) state.x[2].y() = bad;
      if (i == 1) state.velocity[5].z() = bad;
      if (i == 2) air.gravity.x() = bad;
      if (i == 3) motion.end.p.y() = bad;
      EXPECT_FALSE(Step(wound, motion, air, state.View(), scratch)) << bad << " " << i;
      WoundOwned healthy(wound);
      EXPECT_TRUE(Step(wound, {{}, {}, 1.0 / 60}, {}, healthy.View(), scratch));
    }
  }
}

}  // namespace
}  // namespace mane::rod
