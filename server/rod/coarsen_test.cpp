// Properties of a strand with merged elements:
//   rest     its merged rest shape is an equilibrium, to rounding, for every hair type and root
//   length   lengths and angles are sums, and so is the strand's length
//   stable   whether it stays there is told
//   field    velocities at the Gauss points are those of finite differences

#include "rod/coarsen.h"

#include <gtest/gtest.h>

#include "rod/chain.h"
#include "rod/energy.h"
#include "rod/statics.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Random;
using fixtures::State;

const Vector3d kGravity(0, -9.81, 0);

RestingStrand AtRest(const Strand& strand, const math::Pose& clamp) {
  State state(strand);
  EXPECT_TRUE(SolveRestShape(strand, clamp, kGravity, state.theta).converged);
  return {strand, state.theta};
}

TEST(CoarsenTest, MergesByParts) {
  std::vector<double> values{1, 2, 3, 4, 5};
  Merge({0, 1, 1, 1, 2}, &values);
  EXPECT_EQ(values, (std::vector<double>{1, 9, 5}));
  Merge({0, 0, 0}, &values);
  EXPECT_EQ(values, (std::vector<double>{15}));
}

// Pairs, and the rest alone.
Parts Pairs(int N) {
  Parts parts;
  for (int Q = 0; Q < N; ++Q) parts.push_back(Q / 2);
  return parts;
}

TEST(CoarsenTest, TheMergedRestShapeIsAnEquilibrium) {
  Random random(11);
  for (int i = 0; i < 60; ++i) {
    const fixtures::Hair& hair = fixtures::AppendixB()[i % 4];
    const math::Pose clamp = random.Pose();
    RestingStrand strand =
        AtRest(fixtures::MakeStrand(hair, random.Uniform(0.05, 0.4), 5 + i % 7), clamp);
    for (int level = 0; level < 2; ++level) {
      bool stable = false;
      const double length = strand.strand.TotalLength();
      strand = Coarsen(strand, Pairs(strand.strand.elements()), clamp, kGravity, &stable);
      EXPECT_NEAR(strand.strand.TotalLength(), length, 1e-15);
      std::vector<Vector3d> gradient(strand.rest.size());
      PotentialGradient(strand.strand, clamp, kGravity, strand.rest, gradient);
      for (const Vector3d& g : gradient) {
        EXPECT_LT(g.norm(), 1e-12 * strand.strand.linear_density * 9.81 * length * length);
      }
      if (!stable) continue;  // Settling from nearby comes back.
      std::vector<Vector3d> theta = strand.rest;
      for (Vector3d& t : theta) t += random.Vector(1e-4);
      EXPECT_TRUE(SolveRestShape(strand.strand, clamp, kGravity, theta).converged);
      for (size_t Q = 0; Q < theta.size(); ++Q) {
        EXPECT_LT((theta[Q] - strand.rest[Q]).norm(), 1e-6) << hair.name;
      }
    }
  }
}

TEST(CoarsenTest, TellsWhereTheMergedShapeWouldFallOver) {
  // Straight up, beyond Greenhill's number, is an equilibrium that does not last.
  const math::Pose upright{
      Vector3d::Zero(), Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), Vector3d::UnitY())};
  for (const double number : {4.0, 20.0}) {
    const Strand strand = fixtures::HeavyStrand(number, 8);
    bool stable = false;
    (void)Coarsen({strand, std::vector<Vector3d>(8, Vector3d::Zero())}, Pairs(8), upright, kGravity,
                  &stable);
    EXPECT_EQ(stable, number < 7.8) << number;
  }
}

TEST(CoarsenTest, GaussVelocitiesAreThoseOfFiniteDifferences) {
  Random random(12);
  for (int i = 0; i < 20; ++i) {
    const Strand strand = random.UnevenStrand(4, 0.3, 2);
    const State state = random.AnyState(strand, 1, 10, 0);
    const math::Pose clamp = random.Pose();
    const Vector3d velocity = random.Vector(2), spin = random.Vector(5);
    std::vector<Vector3d> field(4 * kGaussPoints);
    GaussVelocities(strand.length, clamp, velocity, spin, state.theta, state.rate, field);
    constexpr double kStep = 1e-6;
    for (int Q = 0; Q < 4; ++Q) {
      for (int g = 0; g < kGaussPoints; ++g) {
        const auto at = [&](double t) {
          const math::Pose moved{clamp.p + t * velocity,
                                 math::FromRotationVector(t * spin) * clamp.q};
          std::vector<Vector3d> theta = state.theta;
          for (int P = 0; P < 4; ++P) theta[P] += t * state.rate[P];
          return PointAt(strand, moved, theta, {Q, kGauss.nodes[g]}).r;
        };
        const Vector3d expected = (at(kStep) - at(-kStep)) / (2 * kStep);
        EXPECT_LT((field[Q * kGaussPoints + g] - expected).norm(), 1e-7 * (1 + expected.norm()));
      }
    }
  }
}

}  // namespace
}  // namespace mane::rod
