// Laws of how batched strands rub on bodies and rest, on every instruction set:
//   incline     hair that lies across a slope stays below the angle of friction and slides above it
//   held        what is held does not creep; what lets go is still rubbed with what friction takes
//   planes      a body that goes on under hair without changing its place does not shake it
//   groove      hair that several bodies touch lies still
//   scales      friction over pressure follows the cosine law wherever hair slides

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact/test_among.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;
using fixtures::Among;
using fixtures::kDt;
using fixtures::Lying;
using fixtures::Table;
using rod::fixtures::State;

// How far the tip moves between two times [s] on a slope of `angle` across the hair, which it
// begins on at rest.
double Slide(simd::Isa isa, double mu, double angle, double from, double to) {
  const Lying lying(8);
  Among hair(isa, Table(), {mu, 0});
  hair.Add(lying.strand, lying.root, State(lying.strand));
  hair.Pack();
  rod::Surroundings air;
  air.gravity = 9.81 * Vector3d(0, -std::cos(angle), std::sin(angle));
  Vector3d start = Vector3d::Zero();
  for (int i = 0; i < to / kDt; ++i) {
    if (i == std::lround(from / kDt)) start = hair.Tip(0);
    EXPECT_EQ(hair.Step({{}, {}, kDt}, air, {}), 0U);
  }
  return (hair.Tip(0) - start).norm();
}

TEST(BatchFrictionTest, HairOnASlopeSlidesAboveTheAngleOfFriction) {
  for (const simd::Isa isa : simd::Supported()) {
    for (const double mu : {0.1, 0.3, 0.6, 1.0}) {
      double holds = 0.5 * std::atan(mu), slides = std::min(1.5, 1.5 * std::atan(mu));
      for (int i = 0; i < 7; ++i) {
        const double angle = 0.5 * (holds + slides);
        (Slide(isa, mu, angle, 0.5, 2.5) < 1e-3 ? holds : slides) = angle;
      }
      EXPECT_NEAR(0.5 * (holds + slides) / std::atan(mu), 1, 0.05) << mu << " " << simd::Name(isa);
    }
  }
}

// Two tables that lean towards each other, with curled hair in the groove between them: each pushes
// it onto the other.
TEST(BatchFrictionTest, HairBetweenTwoBodiesLiesStill) {
  for (const simd::Isa isa : simd::Supported()) {
    for (const double lean : {0.4, 0.7, 1.0}) {
      Lying lying(8);
      for (int Q = 0; Q < 8; ++Q) {
        lying.strand.natural[Q] = Vector3d(0, (Q % 2 == 0 ? 40 : -40), 25);
      }
      const auto table = [&](double side) {
        return math::Pose{{0, 0, 0}, math::FromRotationVector(Vector3d(side * lean, 0, 0))};
      };
      Among hair(isa, Table(), {0.1, 0});
      hair.AddBody(Table(), table(1), {0.1, 0});
      hair.AddBody(Table(), table(-1), {0.1, 0});
      hair.Add(lying.strand, lying.root, State(lying.strand));
      hair.Pack();
      for (int i = 0; i < 5 / kDt; ++i) EXPECT_EQ(hair.Step({{}, {}, kDt}, {}, {}), 0U);
      double fastest = 0;
      for (int i = 0; i < 1 / kDt; ++i) {
        const Vector3d before = hair.Tip(0);
        EXPECT_EQ(hair.Step({{}, {}, kDt}, {}, {}), 0U);
        fastest = std::max(fastest, (hair.Tip(0) - before).norm() / kDt);
      }
      EXPECT_LT(fastest, 1e-4) << lean << " " << simd::Name(isa);
    }
  }
}

TEST(BatchFrictionTest, WhatIsHeldDoesNotCreep) {
  for (const simd::Isa isa : simd::Supported()) {
    EXPECT_LT(Slide(isa, 0.6, 0.7 * std::atan(0.6), 3, 13), 2e-6) << simd::Name(isa);
  }
}

// A slope that tilts ever more across curled hair: point after point reaches its limit. What lets
// go must not leave to others what friction still takes of it, or they let go, too.
TEST(BatchFrictionTest, WhatLetsGoIsStillRubbedInFull) {
  for (const simd::Isa isa : simd::Supported()) {
    constexpr double kMu = 0.4;
    Lying lying(8);
    for (int Q = 0; Q < 8; ++Q) {
      lying.strand.natural[Q] = Vector3d(0, (Q % 2 == 0 ? 40 : -40), 25);
    }
    Among hair(isa, Table(), {kMu, 0});
    hair.Add(lying.strand, lying.root, State(lying.strand));
    hair.Pack();
    std::vector<bool> held(hair.points(), false);
    int let_go = 0;
    double least = 1;
    for (int step = 0; step < 20 / kDt; ++step) {
      const double angle = std::max(0.0, 0.02 * (step * kDt - 5));
      rod::Surroundings air;
      air.gravity = 9.81 * Vector3d(0, -std::cos(angle), std::sin(angle));
      ASSERT_EQ(hair.Step({{}, {}, kDt}, air, {}), 0U);
      for (int i = 0; i < hair.points(); ++i) {
        const Among::Meeting meeting = hair.MeetingOf(i);
        if (meeting.rub < -0.5 && held[i] && step > 5 / kDt &&
            meeting.pressing > 0.5 * 9.81 * kDt * meeting.mass) {
          ++let_go;
          least = std::min(least, meeting.friction.norm() / (kMu * meeting.pressing));
        }
        held[i] = meeting.rub > 0.5;
      }
    }
    EXPECT_GT(let_go, 3) << simd::Name(isa);
    EXPECT_GT(least, 0.3) << simd::Name(isa);
  }
}

// Hair over a ball that turns about its centre, without friction: its place stays what it is.
TEST(BatchFrictionTest, ABallThatTurnsSlowlyDoesNotShakeTheHairOnIt) {
  for (const simd::Isa isa : simd::Supported()) {
    Among hair(isa, Ellipsoid({0.05, 0.05, 0.05}), {0, 0});
    rod::Strand strand = rod::fixtures::HeavyStrand(300, 8);
    strand.air_drag = 10 * strand.linear_density;
    hair.Add(strand, {{0, 0.0505, 0}, Eigen::Quaterniond::Identity()}, State(strand));
    hair.Pack();
    const auto ball = [](int step) {
      return math::Pose{{0, 0, 0}, math::FromRotationVector({0, 0.05 * step * kDt, 0})};
    };
    double fastest = 0;
    for (int step = 0; step < 16 / kDt; ++step) {
      const Vector3d before = hair.Tip(0);
      ASSERT_EQ(hair.Step({{}, {}, kDt}, {}, {ball(step), ball(step + 1), kDt}), 0U);
      if (step > 10 / kDt) fastest = std::max(fastest, (hair.Tip(0) - before).norm() / kDt);
    }
    EXPECT_LT(fastest, 2e-4) << simd::Name(isa);
  }
}

// The table is drawn away under hair that lies on it, in any direction.
TEST(BatchFrictionTest, FrictionFollowsTheCosineLawInEveryDirection) {
  for (const simd::Isa isa : simd::Supported()) {
    for (int turn = 0; turn < 8; ++turn) {
      const double angle = turn * M_PI / 4;
      const Friction friction{0.3, 0.5};
      const Lying lying(8);
      Among hair(isa, Table(), friction);
      hair.Add(lying.strand, lying.root, State(lying.strand));
      hair.Pack();
      const Vector3d speed = 0.05 * Vector3d(std::cos(angle), 0, std::sin(angle));
      double friction_impulse = 0, expected = 0;
      for (int step = 0; step < 140; ++step) {
        const auto at = [&](int k) {
          return math::Pose{k * kDt * speed, Eigen::Quaterniond::Identity()};
        };
        ASSERT_EQ(hair.Step({{}, {}, kDt}, {}, {at(step), at(step + 1), kDt}), 0U);
        if (step < 80) continue;  // Until it lies along and slides.
        for (int i = 0; i < hair.points(); ++i) {
          const Among::Meeting meeting = hair.MeetingOf(i);
          // What hardly slides any more is held (K3).
          if (meeting.rub > -0.5 || meeting.hold > 900 * meeting.mass) continue;
          const Vector3d over = meeting.velocity - speed,
                         slip = over - meeting.normal * meeting.normal.dot(over);
          friction_impulse += meeting.hold * slip.norm();
          expected += friction.Coefficient(slip, meeting.tangent) * meeting.pressing;
        }
      }
      EXPECT_GT(expected, 1);
      const double share = friction_impulse / expected;
      // Drawn to its root, hair buckles and hops: friction is then a step behind, and less.
      EXPECT_GT(share, std::cos(angle) > -0.1 ? 0.97 : 0.5) << angle << " " << simd::Name(isa);
      EXPECT_LT(share, 1.03) << angle << " " << simd::Name(isa);
    }
  }
}

}  // namespace
}  // namespace mane::contact
