// Laws of one strand among obstacles, in the double-precision step:
//   incline   hair that lies across a slope stays below the angle of friction and slides above it
//   rest      hair that falls on a head comes to rest on it, stays, and is nowhere in it
//   stop      hair that hits a wall stops there instead of bouncing
//   energy    a wall that does not move gives hair no energy, at any step
//   bounded   whatever moves, and however deep hair begins, the state stays finite
//   free      without an obstacle near it the step is rod::Step, by a bit
//   scales    mu follows the cosine of the sliding direction to the hair

#include "contact/strand_contact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rod/chain.h"
#include "rod/energy.h"
#include "rod/test_strands.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;
using rod::fixtures::State;

constexpr double kDt = 1.0 / 60;

BodyMotion Still(const math::Pose& pose) { return {pose, pose, 0}; }

// The half space below y = 0, as a ball so large that 0.2 m of it are flat to 0.2 mm.
Obstacle Ground(double mu, double anisotropy = 0) {
  return {
      {Ellipsoid{Vector3d::Constant(100)}, Still({{0, -100, 0}, Eigen::Quaterniond::Identity()})},
      {mu, anisotropy}};
}

// Soft straight hair along x, N elements of equal length, on the ground from its root on.
struct Lying {
  rod::Strand strand;
  math::Pose root{{0, 5e-4, 0}, Eigen::Quaterniond::Identity()};

  explicit Lying(int N) : strand(rod::fixtures::HeavyStrand(2e4, N)) {
    strand.air_drag = 2 * strand.linear_density;  // Settles within some seconds.
  }
};

double Fastest(const State& state) { return rod::fixtures::Largest(state.velocity); }

// How far the tip moves in two seconds on a slope of `angle` across the hair, once it has sunk on
// the ground, which is as flat as its ball.
double Slide(double mu, double angle) {
  const Lying lying(8);
  State state(lying.strand);
  const Obstacle ground = Ground(mu);
  rod::Surroundings air;
  air.gravity = 9.81 * Vector3d(0, -std::cos(angle), std::sin(angle));
  ContactScratch scratch;
  Vector3d start = Vector3d::Zero();
  for (int i = 0; i < 2.2 / kDt; ++i) {
    if (i == 12) start = rod::fixtures::Tip(lying.strand, lying.root, state.theta);
    EXPECT_TRUE(StepWithContact(lying.strand, {lying.root, lying.root, kDt}, air, {&ground, 1}, {},
                                state.View(), scratch)
                    .finite);
  }
  return (rod::fixtures::Tip(lying.strand, lying.root, state.theta) - start).norm();
}

TEST(StrandContactTest, HairOnASlopeSlidesAboveTheAngleOfFriction) {
  for (const double mu : {0.1, 0.3, 0.6, 1.0}) {
    double holds = 0.5 * std::atan(mu), slides = std::min(1.5, 1.5 * std::atan(mu));
    for (int i = 0; i < 7; ++i) {
      const double angle = 0.5 * (holds + slides);
      (Slide(mu, angle) < 5e-4 ? holds : slides) = angle;
    }
    EXPECT_NEAR(0.5 * (holds + slides) / std::atan(mu), 1, 0.05) << mu;
  }
}

TEST(StrandContactTest, HairThatFallsOnAHeadRestsOnIt) {
  const Obstacle head{{Ellipsoid{{0.08, 0.1, 0.09}}, {}}, {0.3, 0.25}};
  for (const rod::fixtures::Hair& hair : rod::fixtures::AppendixB()) {
    if (hair.name == "fuzzy") continue;  // Plain elements do not resolve its coils.
    const rod::Strand strand = rod::fixtures::MakeStrand(hair, 0.2, 10);
    // From the crown, sideways and a little up.
    const Vector3d out = Vector3d(1, 0.5, 0.3).normalized();
    const math::Pose root{Vector3d(0.02, 0.095, 0),
                          Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), out)};
    State state(strand);
    ContactScratch scratch;
    for (int i = 0; i < 5 / kDt; ++i) {
      ASSERT_TRUE(
          StepWithContact(strand, {root, root, kDt}, {}, {&head, 1}, {}, state.View(), scratch)
              .finite);
    }
    EXPECT_LT(Fastest(state), 1e-3) << hair.name;
    for (int Q = 1; Q < strand.elements(); ++Q) {
      for (const double s : {1.0 / 3, 2.0 / 3, 1.0}) {
        const Vector3d r = rod::PointAt(strand, root, state.theta, {Q, s}).r;
        EXPECT_GT(At(head.body.shape, r).distance, 4e-4) << hair.name;
      }
    }
  }
}

TEST(StrandContactTest, HairThatHitsAWallStops) {
  // Swings down on the ground about its root, hinged by softness.
  const Lying lying(6);
  State state(lying.strand);
  math::Pose root = lying.root;
  root.q = Eigen::AngleAxisd(0.5, Vector3d::UnitZ());
  root.p.y() = 5e-4;
  const Obstacle ground = Ground(0.3);
  ContactScratch scratch;
  double fastest = 0, speed = 0;
  for (int i = 0; i < 4 / kDt; ++i) {
    ASSERT_TRUE(StepWithContact(lying.strand, {root, root, kDt}, {}, {&ground, 1}, {}, state.View(),
                                scratch)
                    .finite);
    speed = Fastest(state);
    fastest = std::max(fastest, speed);
  }
  EXPECT_GT(fastest, 0.5);
  EXPECT_LT(speed, 2e-3);
}

TEST(StrandContactTest, AWallGivesNoEnergy) {
  rod::fixtures::Random random(41);
  rod::Surroundings air;
  air.gravity.setZero();
  const Obstacle ground = Ground(0.5);
  ContactScratch scratch;
  for (int i = 0; i < 30; ++i) {
    const rod::Strand strand = random.UnevenStrand(5, 0.2, 1);
    const math::Pose root{{0, 0.05, 0}, random.Rotation()};
    State state(strand);
    for (Vector3d& rate : state.rate) rate = random.Vector(20);
    rod::GaussVelocities(strand.length, root, Vector3d::Zero(), Vector3d::Zero(), state.theta,
                         state.rate, state.velocity);
    const double dt = std::pow(10, random.Uniform(-3, -1));
    // What a wall owes hair that begins inside it is not at issue here.
    ContactSettings settings;
    settings.recovery_speed = 0;
    const auto energy = [&] {
      return rod::KineticEnergy(strand, state.velocity) + rod::ElasticEnergy(strand, state.theta);
    };
    double before = energy();
    const double start = before;
    for (int step = 0; step < 100; ++step) {
      ASSERT_TRUE(StepWithContact(strand, {root, root, dt}, air, {&ground, 1}, settings,
                                  state.View(), scratch)
                      .finite);
      const double now = energy();
      EXPECT_LE(now, before + 1e-6 * start) << i << " dt=" << dt << " step " << step;
      before = now;
    }
  }
}

TEST(StrandContactTest, IsBoundedAmongHostileBodies) {
  rod::fixtures::Random random(42);
  ContactScratch scratch;
  for (int i = 0; i < 20; ++i) {
    const rod::Strand strand = random.UnevenStrand(5, 0.2, 2);
    State state(strand);
    math::Pose root = random.Pose(), ball = random.Pose();
    for (int step = 0; step < 60; ++step) {
      const math::Pose next{root.p + random.Vector(0.3), random.Rotation()},
          rolled{next.p + random.Vector(0.1), random.Rotation()};
      const double dt = random.Uniform(0.001, 0.1);
      const Obstacle body{{Ellipsoid{{0.1, 0.12, 0.11}}, {ball, rolled, dt}}, {0.8, 0.5}};
      ASSERT_TRUE(
          StepWithContact(strand, {root, next, dt}, {}, {&body, 1}, {}, state.View(), scratch)
              .finite)
          << i << " step " << step;
      root = next, ball = rolled;
    }
  }
}

TEST(StrandContactTest, FarFromBodiesItIsTheStepWithoutThem) {
  rod::fixtures::Random random(43);
  const rod::Strand strand = random.UnevenStrand(6, 0.2, 1);
  State a = random.AnyState(strand, 1, 5, 1), b = a;
  const math::Pose root{{0, 50, 0}, Eigen::Quaterniond::Identity()};
  const Obstacle ground = Ground(0.5);
  ContactScratch scratch;
  rod::StepScratch plain;
  for (int i = 0; i < 10; ++i) {
    const ContactReport report =
        StepWithContact(strand, {root, root, kDt}, {}, {&ground, 1}, {}, a.View(), scratch);
    EXPECT_EQ(report.touching, 0);
    ASSERT_TRUE(rod::Step(strand, {root, root, kDt}, {}, b.View(), plain));
  }
  EXPECT_EQ(a.theta, b.theta);
  EXPECT_EQ(a.velocity, b.velocity);
}

TEST(FrictionTest, FollowsTheCosineOfTheSlidingDirection) {
  const Friction friction{0.4, 0.5};
  const Vector3d tangent = Vector3d::UnitX();
  EXPECT_DOUBLE_EQ(friction.Coefficient({2, 0, 0}, tangent), 0.6);   // Towards the tip: held.
  EXPECT_DOUBLE_EQ(friction.Coefficient({-3, 0, 0}, tangent), 0.2);  // Towards the root: glides.
  EXPECT_DOUBLE_EQ(friction.Coefficient({0, 1, 0}, tangent), 0.4);
  EXPECT_NEAR(friction.Coefficient({1, 1, 0}, tangent), 0.4 * (1 + 0.5 * std::sqrt(0.5)), 1e-15);
  EXPECT_DOUBLE_EQ(friction.Coefficient({0, 0, 0}, tangent), 0.4);
}

}  // namespace
}  // namespace mane::contact
