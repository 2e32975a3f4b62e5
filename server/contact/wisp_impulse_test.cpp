// Laws of the impulses between wisps, watched on rods in a void:
//   stop       what collides does not pass through, whatever its speed, and does not bounce
//   energy     a collision gives no kinetic energy
//   momentum   impulses sum to zero; their moment is that of what is not along the normal
//   support    a rod that lies on two others comes to rest and compresses them a little
//   friction   it slides where Coulomb's law says so
//   sliding    curly hair slides less far than straight hair, and never turns round
//   cohesion   curly hair that touches parts more slowly than straight hair
//   bounded    no impulse is more than a pair could need
//   mass       one pass of a collision tells how heavy strands are

#include "contact/wisp_impulse.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <limits>

#include "contact/test_wisps.h"
#include "math/random.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;
using fixtures::Hair;
using fixtures::Impulses;
using fixtures::kDt;
using fixtures::Rods;

constexpr float kRadius = 0.005f;  // Two of them touch at 10 mm.

struct Collision {
  double dt;
  double speed;
  int passes;
  bool rigid;
  bool extrapolates;
};

// A rod that flies at another, across it but for `turn` and `slant` [rad].
Rods Colliding(const Collision& collision, double turn, double slant, double off) {
  Rods rods;
  rods.settings.root_length = 0;
  rods.passes = collision.passes;
  rods.extrapolates = collision.extrapolates;
  const int points = collision.rigid ? 11 : 2;
  const Eigen::AngleAxisd turned(turn, Vector3d::UnitY()), slanted(slant, Vector3d::UnitX());
  const Vector3d along = turned * slanted * Vector3d(0, 0, 0.05);
  const Vector3d middle(off, 0.04, 0.3 * off);
  rods.Add({-0.05, 0, 0}, {0.05, 0, 0}, points, 1e-4, kRadius, 0, Vector3d::Zero(),
           collision.rigid);
  rods.Add(middle - along, middle + along, points, 1e-4, kRadius, 0, {0, -collision.speed, 0},
           collision.rigid);
  rods.WatchDistance();
  return rods;
}

void ExpectStops(const Collision& collision, double turn, double slant, double off) {
  SCOPED_TRACE(testing::Message() << "dt " << collision.dt << ", " << collision.speed << " m/s, "
                                  << collision.passes << " passes, rigid " << collision.rigid
                                  << ", extrapolates " << collision.extrapolates << ", turn "
                                  << turn << ", slant " << slant << ", off " << off);
  Rods rods = Colliding(collision, turn, slant, off);
  const double energy = rods.KineticEnergy();
  const Vector3d momentum = rods.Momentum();
  double most = 0, left = 0;
  for (int i = 0; i < 0.1 / collision.speed / collision.dt + 4; ++i) {
    rods.Step(collision.dt);
    most = std::max(most, rods.KineticEnergy());
    left = rods.KineticEnergy();
  }
  // At 4 m/s and 60 Hz a rod that is hit off its middle turns by a third of a radian in the step.
  const double whole = collision.speed * collision.dt < 0.05 ? 0.5 : 0.3;
  EXPECT_GT(rods.least_distance(), whole * 2 * kRadius);
  EXPECT_LT(rods.least_distance(), 1.1 * 2 * kRadius);  // They met.
  EXPECT_LE(most, energy * (1 + 1e-6));
  EXPECT_LT(left, 0.9 * energy);
  EXPECT_LT((rods.Momentum() - momentum).norm(), 1e-5 * momentum.norm());
  const Vector3d apart = rods.Centre(1) - rods.Centre(0);
  EXPECT_TRUE(slant != 0 || apart.y() > 0);
}

TEST(WispImpulseTest, WhatCollidesDoesNotPassThroughAndGainsNoEnergy) {
  for (const double speed : {0.1, 1.0, 4.0}) {
    for (const double dt : {1.0 / 240, kDt}) {
      for (const int passes : {2, 3, 4}) {
        for (const bool extrapolates : {false, true}) {
          ExpectStops({dt, speed, passes, false, extrapolates}, 0, 0, 0.003);
          // Where a strand is heavier than its points, two passes see it only if it is fast.
          if (passes > 2) ExpectStops({dt, speed, passes, true, extrapolates}, 0, 0, 0.003);
        }
      }
    }
  }
}

TEST(WispImpulseTest, CollisionsOfAllDirectionsStop) {
  math::RandomStream random(1, 0);
  for (int i = 0; i < 100; ++i) {
    const double turn = random.Uniform(-1, 1), slant = random.Uniform(-0.3, 0.3);
    const double off = random.Uniform(-0.02, 0.02);
    // A rod that is hit near its end at 4 m/s would turn by a radian within 1/60 s.
    ExpectStops({kDt, 1, 3, true, true}, turn, slant, off);
    ExpectStops({kDt / 4, 4, 3, true, true}, turn, slant, off);
    ExpectStops({kDt, 4, 3, true, true}, turn, 0.5 * slant, 0.5 * off);
  }
}

TEST(WispImpulseTest, WhatIsStoppedDoesNotBounce) {
  for (const bool extrapolates : {false, true}) {
    for (const double speed : {0.1, 1.0, 4.0}) {
      Rods rods = Colliding({kDt, speed, 3, true, extrapolates}, 0, 0, 0);
      for (int i = 0; i < 0.1 / speed / kDt + 4; ++i) rods.Step(kDt);
      const double parting = (rods.MeanVelocity(1) - rods.MeanVelocity(0)).y();
      std::printf("%.1f m/s parts at %.3f m/s\n", speed, parting);
      EXPECT_LT(parting, std::max(0.1, 0.03 * speed));  // WispSettings::recovery_speed.
    }
  }
}

TEST(WispImpulseTest, ImpulsesSumToZeroAndTheirMomentIsThatOfWhatRubs) {
  for (const uint64_t seed : {1, 2, 3}) {
    Hair hair = fixtures::HeadOfHair(100, seed);
    exec::WorkerPool pool(1);
    WispTracker tracker;
    WispScratch scratch;
    Impulses impulses(hair.size());
    tracker.Begin(hair.View(), kDt, scratch, pool, impulses.View());
    Hair moving = hair;
    fixtures::Shake(0.5, seed, &moving);
    for (int pass = 0; pass < 3; ++pass) {
      tracker.Revise({moving.ux, moving.uy, moving.uz}, scratch, pool, impulses.View());
      EXPECT_GT(impulses.SumOfNorms(), 0);
      EXPECT_LT(impulses.Sum().norm(), 1e-6 * impulses.SumOfNorms());

      // At rest the normal lies along the line of the two points: only what rubs has an arm.
      Vector3d moment = Vector3d::Zero();
      for (size_t p = 0; p < hair.size(); ++p) {
        moment += hair.View().Position(p).cast<double>().cross(impulses.At(p));
      }
      double bound = 0;
      for (const WispPair& pair : tracker.pairs()) {
        const Eigen::Vector3f across = pair.impulse - pair.impulse.dot(pair.normal) * pair.normal;
        bound += (pair.gap + pair.reference) * across.norm();
      }
      EXPECT_LT(moment.norm(), bound + 1e-6 * impulses.SumOfNorms());
      EXPECT_GT(bound, 0);
    }
  }
}

// A light rod on two heavy ones that nothing moves, pulled down and by `side` of it across.
Rods Lying(double side, double sliding_rate) {
  Rods rods;
  rods.settings.root_length = 0;
  rods.settings.sliding_rate_straight = sliding_rate;
  for (const double x : {-0.03, 0.03}) {
    rods.Add({x, 0, -0.05}, {x, 0, 0.05}, 11, 1e5, kRadius, 0, Vector3d::Zero(), true);
  }
  rods.Add({-0.05, 0.0101, -0.03}, {0.05, 0.0101, -0.03}, 11, 1e-4, kRadius, 0, Vector3d::Zero(),
           true, 9.81 * Vector3d(0, -1, side));
  return rods;
}

TEST(WispImpulseTest, ARodOnTwoOthersComesToRestAndCompressesThem) {
  for (const bool extrapolates : {false, true}) {
    Rods rods = Lying(0, 2);
    rods.extrapolates = extrapolates;
    for (int i = 0; i < 120; ++i) rods.Step(kDt);
    EXPECT_LT(rods.MeanVelocity(2).norm(), 1e-3);
    const double compression = 1 - rods.Distance(0, 2) / (2 * kRadius);
    std::printf("compressed by %.4f of the radii\n", compression);
    EXPECT_GT(compression, 1e-3);
    EXPECT_LT(compression, 0.2);
  }
}

// Rods in layers, each across the one below, on heavy ones that nothing moves.
TEST(WispImpulseTest, APileOfRodsComesToRestAndStandsUp) {
  constexpr size_t kLayers = 4;
  for (const bool extrapolates : {false, true}) {
    Rods rods;
    rods.settings.root_length = 0;
    rods.extrapolates = extrapolates;
    for (size_t layer = 0; layer <= kLayers; ++layer) {
      for (int k = 0; k < 4; ++k) {
        const double off = -0.0375 + 0.025 * k, height = 0.01 * static_cast<double>(layer);
        const bool along_x = layer % 2 == 1;
        const Vector3d a = along_x ? Vector3d(-0.05, height, off) : Vector3d(off, height, -0.05);
        const Vector3d b = along_x ? Vector3d(0.05, height, off) : Vector3d(off, height, 0.05);
        rods.Add(a, b, 11, layer == 0 ? 1e5 : 1e-4, kRadius, 0.5f, Vector3d::Zero(), true,
                 Vector3d(0, layer == 0 ? 0 : -9.81, 0));
      }
    }
    for (int i = 0; i < 240; ++i) {
      rods.weight_scale = std::min(1.0, i / 60.0);
      rods.Step(kDt);
    }
    double fastest = 0, lowest = 1;
    for (size_t rod = 4; rod < 4 * (kLayers + 1); ++rod) {
      fastest = std::max(fastest, rods.MeanVelocity(rod).norm());
      const double layer = static_cast<double>(rod / 4);
      lowest = std::min(lowest, rods.Centre(rod).y() / (0.01 * layer));
    }
    std::printf("pile: fastest %.2e m/s, compressed to %.3f\n", fastest, lowest);
    EXPECT_LT(fastest, 2e-3);
    EXPECT_GT(lowest, 0.9);
  }
}

TEST(WispImpulseTest, HairSlidesWhereCoulombsLawSaysSo) {
  const WispSettings settings;
  double held = 0, slid = 0;
  for (double slope = 0.05; slope < 0.16; slope += 0.01) {
    Rods rods = Lying(slope, 0);
    for (int i = 0; i < 30; ++i) rods.Step(kDt);
    const double lying = rods.Centre(2).z();
    for (int i = 0; i < 30; ++i) rods.Step(kDt);
    const double moved = rods.Centre(2).z() - lying;
    if (moved < 2e-4) held = slope;
    if (moved > 2e-3 && slid == 0) slid = slope;
  }
  std::printf("mu %.2f: held at %.2f, slides at %.2f\n", settings.friction_straight, held, slid);
  EXPECT_NEAR(held, settings.friction_straight, 0.021);
  EXPECT_NEAR(slid, settings.friction_straight, 0.021);
}

// How far a rod slides along another that it touches, in half a second [m].
double SlideAlong(float curly) {
  Rods rods;
  rods.settings.root_length = 0;
  rods.Add({-0.4, 0, 0}, {0.4, 0, 0}, 60, 1e-3, kRadius, curly, Vector3d::Zero(), true);
  rods.Add({-0.4, 0.01, 0}, {-0.2, 0.01, 0}, 15, 1e-4, kRadius, curly, {0.5, 0, 0}, true);
  for (int i = 0; i < 30; ++i) {
    rods.Step(kDt);
    EXPECT_GE((rods.MeanVelocity(1) - rods.MeanVelocity(0)).x(), -1e-6);
  }
  return (rods.Centre(1) - rods.Centre(0)).x() + 0.3;
}

TEST(WispImpulseTest, CurlyHairSlidesLessFarThanStraightHair) {
  const double straight = SlideAlong(0), wavy = SlideAlong(0.5f), curly = SlideAlong(1);
  std::printf("slides %.3f m straight, %.3f m wavy, %.3f m curly\n", straight, wavy, curly);
  EXPECT_GT(straight, 1.5 * wavy);
  EXPECT_GT(wavy, 1.2 * curly);
  EXPECT_GT(curly, 0);
}

// At what speed rods part that touched and moved apart at 0.05 m/s, after 0.3 s.
double Parting(float curly, double distance) {
  Rods rods;
  rods.settings.root_length = 0;
  rods.Add({-0.05, 0, 0}, {0.05, 0, 0}, 11, 1e-4, kRadius, curly, Vector3d::Zero(), true);
  rods.Add({0, distance, -0.05}, {0, distance, 0.05}, 11, 1e-4, kRadius, curly, {0, 0.05, 0}, true);
  double energy = rods.KineticEnergy();
  for (int i = 0; i < 20; ++i) {
    rods.Step(kDt);
    EXPECT_LE(rods.KineticEnergy(), energy * (1 + 1e-6));
    energy = rods.KineticEnergy();
  }
  return (rods.MeanVelocity(1) - rods.MeanVelocity(0)).y();
}

TEST(WispImpulseTest, CurlyHairThatTouchesPartsMoreSlowly) {
  EXPECT_NEAR(Parting(0, 0.01), 0.05, 1e-6);
  EXPECT_LT(Parting(0.7f, 0.01), 0.048);
  EXPECT_LT(Parting(1, 0.01), Parting(0.7f, 0.01));
  EXPECT_GT(Parting(1, 0.01), 0);
  EXPECT_NEAR(Parting(1, 0.0121), 0.05, 1e-6);  // Out of range.
}

TEST(WispImpulseTest, NoImpulseIsMoreThanItCouldNeed) {
  // A push that strands have failed to turn into velocities, as no strand does.
  for (const float before : {1e-3f, 1.0f, 1e30f}) {
    WispPair pair{};
    pair.normal = Eigen::Vector3f::UnitY();
    pair.impulse = before * Eigen::Vector3f(0.5f, 1, 0);
    pair.inverse_mass[0] = pair.inverse_mass[1] = 1e5f;
    pair.normal_mass = pair.sliding_mass = 5e-6f;
    pair.resistance = 1;
    pair.target = 10;
    pair.leaving = 1;
    pair.friction = 1;
    pair.nearness = 1;
    pair.velocity[0] = {0, -2, 0};
    pair.velocity[1] = {0, 1, 0};
    ReviseImpulse(pair);
    EXPECT_GE(pair.impulse.y(), 0);
    EXPECT_LE(pair.impulse.norm(), 1.0001 * 64 * 5e-6 * (2 * 3 + 1)) << before;  // (H12)
    pair.velocity[0].x() = std::numeric_limits<float>::quiet_NaN();
    ReviseImpulse(pair);
    EXPECT_EQ(pair.impulse.norm(), 0);
  }
}

TEST(WispImpulseTest, OnePassOfACollisionTellsHowHeavyStrandsAre) {
  // Two rods that hit each other in the middle: both together, half of one's mass.
  Rods rods = Colliding({kDt, 4, 2, true, false}, 0, 0, 0);
  float mass = 0;
  for (int i = 0; i < 2; ++i) {
    rods.Step(kDt);
    for (const WispPair& pair : rods.tracker().pairs()) mass = pair.normal_mass;
  }
  EXPECT_NEAR(mass / 0.5e-4, 1, 0.2);
}

}  // namespace
}  // namespace mane::contact
