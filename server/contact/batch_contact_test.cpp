// Laws of batched strands among bodies, on every instruction set:
//   energy      a body that does not move gives hair no energy, at any step
//   depth       hair that begins inside a body comes out no faster than it may, and stays out
//   folds       hair between whose points a body is thin or has an edge goes around it
//   far         what is far off is looked at before it is near
//   bounded     whatever moves, the state stays finite
//   neighbours  a lane's bits do not depend on what others meet
//   economy     a warm step does not allocate

#include "contact/batch_contact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/test_allocations.h"
#include "contact/test_among.h"
#include "rod/energy.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;
using fixtures::Among;
using fixtures::kDt;
using fixtures::Lying;
using fixtures::Table;
using rod::Row;
using rod::fixtures::Random;
using rod::fixtures::State;
using rod::layout::kLanes;

TEST(BatchContactTest, ABodyAtRestGivesNoEnergy) {
  for (const simd::Isa isa : simd::Supported()) {
    Random random(41);
    rod::Surroundings air;
    air.gravity.setZero();
    for (int i = 0; i < 12; ++i) {
      const double dt = std::pow(10, random.Uniform(-3, -1.3));
      Among hair(isa, Table(), {0.5, 0.25});
      hair.settings.recovery_speed = 0;  // What a body owes hair inside it is not at issue here.
      std::vector<rod::Strand> strands;
      for (int lane = 0; lane < kLanes; ++lane) {
        const rod::Strand strand = random.UnevenStrand(5, 0.12, 1);
        const math::Pose root{{0, 0.05, 0}, random.Rotation()};
        State state(strand);
        for (Vector3d& rate : state.rate) rate = random.Vector(20);
        rod::GaussVelocities(strand.length, root, Vector3d::Zero(), Vector3d::Zero(), state.theta,
                             state.rate, state.velocity);
        hair.Add(strand, root, state);
        strands.push_back(strand);
      }
      hair.Pack();
      std::vector<double> before(kLanes, 1e9), start(kLanes);
      for (int step = 0; step < 60; ++step) {
        for (int lane = 0; lane < kLanes; ++lane) {
          const State state = hair.Get(lane);
          const double now = rod::KineticEnergy(strands[lane], state.velocity) +
                             rod::ElasticEnergy(strands[lane], state.theta);
          if (step == 0) start[lane] = now;
          EXPECT_LE(now, before[lane] + 2e-3 * start[lane])
              << i << " dt=" << dt << " step " << step << " lane " << lane;
          before[lane] = now;
        }
        ASSERT_EQ(hair.Step({{}, {}, dt}, air, {}), 0U);
      }
    }
  }
}

TEST(BatchContactTest, HairThatBeginsInsideComesOutSmoothly) {
  for (const simd::Isa isa : simd::Supported()) {
    Among hair(isa, Table(), {0.3, 0.25});
    const rod::Strand strand = rod::fixtures::HeavyStrand(2000, 8);
    // From above the table down through it.
    const math::Pose root{
        {0, 0.01, 0},
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), Vector3d(1, -0.2, 0).normalized())};
    hair.Add(strand, root, State(strand));
    hair.Pack();
    rod::Surroundings air;
    air.air_drag_scale = 1;
    double fastest = 0;
    Vector3d tip = hair.Tip(0);
    EXPECT_LT(tip.y(), -0.02);
    for (int i = 0; i < 5 / kDt; ++i) {
      ASSERT_EQ(hair.Step({{}, {}, kDt}, air, {}), 0U);
      fastest = std::max(fastest, (hair.Tip(0) - tip).y() / kDt);
      tip = hair.Tip(0);
    }
    EXPECT_LT(fastest, 1.2 * hair.settings.recovery_speed + 0.05);
    EXPECT_GT(tip.y(), 0);
    EXPECT_LT(tip.y(), 2e-3);
  }
}

BodyShape FieldOf(const TriangleMesh& mesh) {
  exec::WorkerPool pool(2);
  return *MeshField::Build(mesh, {}, &pool);
}

// A plate upright like an ear, and the edge of a table, which soft hair from above falls on: at any
// place between two of its points.
TEST(BatchContactTest, HairGoesAroundWhatIsThinnerThanItsPointsAreApart) {
  const BodyShape ear = FieldOf(fixtures::Box({-0.1, -0.1, -0.0025}, {0.1, 0, 0.0025}, 8)),
                  edge = FieldOf(fixtures::Box({-0.1, -0.1, -0.1}, {0.1, 0, 0.0025}, 8));
  for (const simd::Isa isa : simd::Supported()) {
    for (const BodyShape& shape : {ear, edge}) {
      for (int place = 0; place < 6; ++place) {
        Among hair(isa, shape, {0.3, 0});
        const rod::Strand strand = rod::fixtures::HeavyStrand(2e4, 4);
        // At first it leads through the plate, 2 mm below its rim.
        const math::Pose root{
            {0, 0.012, -0.06 - 0.0025 * place},
            Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), Vector3d(0, -0.2, 0.9))};
        hair.Add(strand, root, State(strand));
        hair.Pack();
        rod::Surroundings air;
        air.air_drag_scale = 1;
        for (int i = 0; i < 4 / kDt; ++i) ASSERT_EQ(hair.Step({{}, {}, kDt}, air, {}), 0U);
        EXPECT_LT(hair.Deepest(0, shape, 0.02), 1e-3) << place << " " << simd::Name(isa);
        EXPECT_LT(hair.Tip(0).y(), -0.03);  // It hangs over.
        EXPECT_GT(hair.Tip(0).z(), 0);
      }
    }
  }
}

// Hair comes to a slanted plate from aside, where a field says that it is farther off than it is
// (D12).
TEST(BatchContactTest, WhatIsFarIsLookedAtBeforeItIsNear) {
  TriangleMesh plate = fixtures::Box({0, -0.01, -0.3}, {0.57, 0.01, 0.3}, 8);
  const Eigen::Quaternionf slant(
      Eigen::AngleAxisf(0.25F * static_cast<float>(M_PI), Eigen::Vector3f::UnitZ()));
  for (Eigen::Vector3f& vertex : plate.vertices) vertex = slant * vertex;
  const BodyShape shape = FieldOf(plate);
  const Vector3d from(0.46, -0.8, 0), to(0.06, 0.04, 0);
  EXPECT_GT(At(shape, from).distance, 1.05 * (from - to).norm());
  for (const simd::Isa isa : simd::Supported()) {
    Among hair(isa, shape, {0.3, 0});
    const rod::Strand strand = rod::fixtures::HeavyStrand(20, 6);
    const math::Pose root{from,
                          Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), Vector3d::UnitZ())};
    hair.Add(strand, root, State(strand));
    hair.Pack();
    rod::Surroundings air;
    air.gravity.setZero();
    air.air_drag_scale = 1;
    const auto head = [&](int i) {
      const double part = std::min(1.0, 0.5 * i * kDt / (to - from).norm());
      return math::Pose{part * (to - from), Eigen::Quaterniond::Identity()};
    };
    const int steps = static_cast<int>(std::ceil((to - from).norm() / (0.5 * kDt) + 0.5 / kDt));
    for (int i = 0; i < steps; ++i) ASSERT_EQ(hair.Step({head(i), head(i + 1), kDt}, air, {}), 0U);
    EXPECT_LT(hair.Deepest(0, shape, 0.1, head(steps)), 1e-3) << simd::Name(isa);
    EXPECT_GT(hair.Deepest(0, shape, 0.1, head(steps)), -1e-2);  // It has come there.
  }
}

TEST(BatchContactTest, IsBoundedAmongHostileBodies) {
  for (const simd::Isa isa : simd::Supported()) {
    Random random(42);
    for (int i = 0; i < 6; ++i) {
      Among hair(isa, Ellipsoid({0.1, 0.12, 0.11}), {0.8, 0.5});
      for (int lane = 0; lane < kLanes; ++lane) {
        const rod::Strand strand = random.UnevenStrand(5, 0.2, 2);
        hair.Add(strand, random.AnyRoot(), State(strand));
      }
      hair.Pack();
      math::Pose head = random.Pose(), ball = random.Pose();
      for (int step = 0; step < 60; ++step) {
        const math::Pose next{head.p + random.Vector(0.3), random.Rotation()},
            rolled{next.p + random.Vector(0.1), random.Rotation()};
        const double dt = random.Uniform(0.001, 1.0 / 60);
        ASSERT_EQ(hair.Step({head, next, dt}, {}, {ball, rolled, dt}), 0U) << i << " " << step;
        head = next, ball = rolled;
      }
    }
  }
}

TEST(BatchContactTest, LanesDoNotDependOnWhatOthersMeet) {
  for (const simd::Isa isa : simd::Supported()) {
    std::vector<std::vector<float>> results;
    for (const bool others : {false, true}) {
      Random random(9);
      Among hair(isa, Ellipsoid({0.08, 0.1, 0.09}), {0.4, 0.25});
      for (int lane = 0; lane < kLanes; ++lane) {
        const rod::Strand strand = random.UnevenStrand(5, 0.2, 1);
        const math::Pose near = random.AnyRoot();
        math::Pose root{{0.03, 0.08, 0.02}, Eigen::Quaterniond::Identity()};
        if (lane != 3) root = others ? near : math::Pose{{50, 0, 0}, near.q};
        hair.Add(strand, root, State(strand));
      }
      hair.Pack();
      const int lane =
          static_cast<int>(std::find(hair.block().strands.begin(), hair.block().strands.end(), 3) -
                           hair.block().strands.begin());
      std::vector<float> bits;
      for (int step = 0; step < 90; ++step) {
        ASSERT_EQ(hair.Step({{}, {}, kDt}, {}, {}), 0U);
        for (const Row<float>& row : hair.state()) bits.push_back(row.lane[lane]);
      }
      results.push_back(bits);
    }
    EXPECT_EQ(results[0], results[1]) << simd::Name(isa);
  }
}

TEST(BatchContactTest, WarmStepsDoNotAllocate) {
  Among hair(simd::Best(), Table(), {0.3, 0.25});
  const Lying lying(8);
  for (int lane = 0; lane < kLanes; ++lane) {
    hair.Add(lying.strand, lying.root, State(lying.strand));
  }
  hair.Pack();
  ASSERT_EQ(hair.Step({{}, {}, kDt}, {}, {}), 0U);
  const mane::fixtures::AllocationCount count;
  for (int i = 0; i < 20; ++i) ASSERT_EQ(hair.Step({{}, {}, kDt}, {}, {}), 0U);
  EXPECT_EQ(count.count(), 0);
}

}  // namespace
}  // namespace mane::contact