// Energy over a step of a wound strand (rod.md, S8), and its boundedness:
//   identity   the change of T + U is exactly what the scheme says
//   decay      T + U never grows on a clamp at rest without gravity, at any step size
//   bounded    violent motion at 1/30 and 1/60 s, damped or not, leaves curly and fuzzy hair
//   finite,
//              of its length, and at sane speeds; it calms down afterwards

#include <gtest/gtest.h>

#include <cmath>

#include "rod/energy.h"
#include "rod/test_motions.h"
#include "rod/test_wound.h"
#include "rod/test_wound_oracle.h"
#include "rod/wound_shape.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::AnyWound;
using fixtures::Random;
using fixtures::WoundOwned;

double Energy(const WoundStrand& wound, const WoundOwned& state) {
  return KineticEnergy(wound, state.velocity) + ElasticEnergy(wound, state.x);
}

// What (S8) says that a step from `before` to `after` adds to T + U on a clamp at rest.
double PredictedChange(const WoundStrand& wound, const math::Pose& clamp, const Surroundings& air,
                       double dt, const WoundOwned& before, const WoundOwned& after) {
  const oracle::WoundRod rod(wound.strand);
  const oracle::Vector v = oracle::Stack(after.rate), masses = rod.Masses();
  const oracle::Vector ahead = oracle::Stack(before.x) + kTheta * dt * oracle::Stack(before.rate);
  const double nu = air.air_drag_scale * wound.strand.air_drag;
  const double drag = nu / wound.strand.linear_density;
  oracle::Real change = -dt * v.dot(rod.Friction(air.internal_friction_scale, dt) * v) -
                        (kTheta - 0.5) * dt * dt * v.dot(rod.Stiffness() * v);
  for (size_t k = 0; k < before.velocity.size(); ++k) {
    const Vector3d du = after.velocity[k] - before.velocity[k];
    const Vector3d u_x = before.velocity[k] + kTheta * du;
    change -= (kTheta - 0.5) * masses[k] * du.squaredNorm();
    change -= dt * masses[k] * drag * u_x.squaredNorm();
  }
  const oracle::Vector3 body = (air.gravity + drag * air.wind).cast<oracle::Real>();
  change -= dt * v.dot(rod.GravityGradient(oracle::ToFrame(clamp), body, ahead));
  const oracle::Vector last = oracle::Stack(before.rate);
  change -= dt * kTheta * dt * v.dot(rod.Turning(oracle::ToFrame(clamp), body, ahead) * (v - last));
  return static_cast<double>(change);
}

TEST(WoundEnergyTest, ChangesByTheLawOfTheScheme) {
  Random random(2006);
  WoundScratch scratch;
  for (const int N : {1, 2, 5}) {
    for (const double dt : {1e-4, 1.0 / 240, 1.0 / 30, 0.1, 1.0}) {
      const WoundStrand wound = AnyWound(random, N, 0.2, random.Uniform(2, 20));
      const math::Pose clamp = random.Pose();
      const WoundOwned before(wound, random, 0.5, 5, 1);
      Surroundings air;
      air.gravity = random.Vector(10);
      air.wind = random.Vector(3);
      air.air_drag_scale = 3;
      WoundOwned after = before;
      ASSERT_TRUE(Step(wound, {clamp, clamp, dt}, air, after.View(), scratch));
      const double change = Energy(wound, after) - Energy(wound, before);
      const double predicted = PredictedChange(wound, clamp, air, dt, before, after);
      const double scale = Energy(wound, after) + Energy(wound, before);
      EXPECT_NEAR(change, predicted, 1e-10 * scale) << "N=" << N << " dt=" << dt;
    }
  }
}

TEST(WoundEnergyTest, NeverGrowsOnAClampAtRestWithoutGravity) {
  Random random(55);
  WoundScratch scratch;
  Surroundings air;
  air.gravity.setZero();
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const int N = 1 + i % 8;
    WoundStrand wound = i % 2 == 0
                            ? AnyWound(random, N, random.Uniform(0.05, 0.4), random.Uniform(1, 40))
                            : fixtures::MakeGraded(fixtures::AppendixB()[2 + i / 2 % 2], 0.2, N);
    if (i % 3 == 0) {
      wound.strand.internal_friction = 0;
      wound.strand.air_drag = 0;
    }
    WoundOwned state(wound, random, 2, 30, 5);
    const math::Pose clamp = random.Pose();
    const double dt = std::pow(10, random.Uniform(-5, 1));
    double energy = Energy(wound, state);
    const double start = energy;
    for (int step = 0; step < 50; ++step) {
      ASSERT_TRUE(Step(wound, {clamp, clamp, dt}, air, state.View(), scratch));
      const double next = Energy(wound, state);
      ASSERT_LE(next, energy + 1e-11 * start) << "step " << step << " dt=" << dt;
      energy = next;
    }
  }
}

// Checks all inter-point distances of a polyline along the hair against arc length.
void ExpectOfItsLength(const WoundStrand& wound, const math::Pose& clamp, const WoundOwned& state) {
  const int points = 12 * static_cast<int>(std::ceil(NaturalTurns(wound.strand)));
  const double L = wound.strand.TotalLength();
  const std::vector<WoundFrame> frames = WoundFrames(wound, clamp, state.x);
  Vector3d previous = clamp.p;
  for (int i = 1; i <= points; ++i) {
    const Vector3d r = PointOnHair(wound, frames, state.x, L * i / points);
    ASSERT_LE((r - previous).norm(), L / points * (1 + 1e-9));
    previous = r;
  }
}

double Fastest(const std::vector<Vector3d>& velocity) {
  double fastest = 0;
  for (const Vector3d& u : velocity) fastest = std::max(fastest, u.norm());
  return fastest;
}

// Runs `steps` steps and returns the largest speed of any point over the clamp's largest.
double RelativeSpeed(const WoundStrand& wound, const fixtures::Motion& motion, double dt,
                     int steps) {
  WoundOwned state(wound);
  WoundScratch scratch;
  const double L = wound.strand.TotalLength();
  double fastest = 0, clamp_fastest = std::sqrt(2 * 9.81 * L);
  for (int i = 0; i < steps; ++i) {
    const ClampMotion clamp{motion(i, dt), motion(i + 1, dt), dt};
    EXPECT_TRUE(Step(wound, clamp, {}, state.View(), scratch)) << i;
    const double turn = math::RotationVector(clamp.end.q * clamp.begin.q.conjugate()).norm();
    clamp_fastest =
        std::max(clamp_fastest, (clamp.end.p - clamp.begin.p).norm() / dt + turn / dt * L);
    fastest = std::max(fastest, Fastest(state.velocity));
    if (i % 10 == 0 || i + 1 == steps) ExpectOfItsLength(wound, clamp.end, state);
    if (::testing::Test::HasFailure()) break;
  }
  return fastest / clamp_fastest;
}

// As in bounded_test.cpp.
constexpr double kWhip = 5, kUndampedWhip = 15;

class WoundBoundedTest : public ::testing::TestWithParam<int> {
 protected:
  void ExpectBounded(const fixtures::Motion& motion, double dt, int steps, bool damped) {
    const fixtures::Hair& hair = fixtures::AppendixB()[GetParam()];
    for (const double length : {0.1, 0.2, 0.3}) {
      for (const int N : {5, 10}) {
        for (const double variation : {0.0, 0.1}) {  // Of the curl along the hair.
          SCOPED_TRACE(::testing::Message()
                       << hair.name << " L=" << length << " N=" << N << " varied " << variation);
          Random random(71);
          Strand strand =
              fixtures::Varied(fixtures::MakeGraded(hair, length, N).strand, variation, random);
          if (!damped) {
            strand.internal_friction = 0;
            strand.air_drag = 0;
          }
          const double speed = RelativeSpeed(MakeWound(strand), motion, dt, steps);
          EXPECT_LT(speed, damped ? kWhip : kUndampedWhip);
          fastest_ = std::max(fastest_, speed);
        }
      }
    }
    RecordProperty("fastest", std::to_string(fastest_));
  }

  double fastest_ = 0;
};

INSTANTIATE_TEST_SUITE_P(CurlyAndFuzzy, WoundBoundedTest, ::testing::Values(2, 3),
                         [](const auto& hair) { return fixtures::AppendixB()[hair.param].name; });

TEST_P(WoundBoundedTest, Shakes) { ExpectBounded(fixtures::Shake, 1.0 / 30, 900, true); }
TEST_P(WoundBoundedTest, SnapTurns) { ExpectBounded(fixtures::SnapTurn, 1.0 / 30, 900, true); }
TEST_P(WoundBoundedTest, Teleports) { ExpectBounded(fixtures::Teleport, 1.0 / 30, 900, true); }
TEST_P(WoundBoundedTest, ShakesAtASixtieth) {
  ExpectBounded(fixtures::Shake, 1.0 / 60, 1800, true);
}
TEST_P(WoundBoundedTest, TeleportsAtASixtieth) {
  ExpectBounded(fixtures::Teleport, 1.0 / 60, 1800, true);
}
TEST_P(WoundBoundedTest, UndampedShakesAtASixtieth) {
  ExpectBounded(fixtures::Shake, 1.0 / 60, 1800, false);
}
TEST_P(WoundBoundedTest, UndampedSnapTurnsAtASixtieth) {
  ExpectBounded(fixtures::SnapTurn, 1.0 / 60, 1800, false);
}
TEST_P(WoundBoundedTest, UndampedTeleportsAtASixtieth) {
  ExpectBounded(fixtures::Teleport, 1.0 / 60, 1800, false);
}
TEST_P(WoundBoundedTest, UndampedShakesAtATenthOfASecond) {
  ExpectBounded(fixtures::Shake, 0.1, 300, false);
}
TEST_P(WoundBoundedTest, UndampedSpinsAtATenthOfASecond) {
  ExpectBounded(fixtures::Spin, 0.1, 300, false);
}

TEST_P(WoundBoundedTest, CalmsDownAfterTheStorm) {
  const WoundStrand wound = fixtures::MakeGraded(fixtures::AppendixB()[GetParam()], 0.2, 5);
  WoundOwned state(wound);
  WoundScratch scratch;
  const double dt = 1.0 / 30;
  for (int i = 0; i < 90; ++i) {
    const ClampMotion clamp{fixtures::Teleport(i, dt), fixtures::Teleport(i + 1, dt), dt};
    ASSERT_TRUE(Step(wound, clamp, {}, state.View(), scratch));
  }
  const math::Pose still = fixtures::Teleport(90, dt);
  for (int i = 0; i < 1800; ++i) {
    ASSERT_TRUE(Step(wound, {still, still, dt}, {}, state.View(), scratch));
  }
  EXPECT_LT(Fastest(state.velocity), 1e-3);
}

}  // namespace
}  // namespace mane::rod
