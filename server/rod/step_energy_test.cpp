// Energy over a step (rod.md, S8):
//   identity      the change of T + U is exactly what the scheme says: its own damping, friction,
//                 drag and the power of weight and wind
//   decay         T + U never grows on a clamp at rest without gravity, at any step size
//   conservation  T + U + V is constant in the limit dt -> 0 when nothing damps

#include <gtest/gtest.h>

#include <cmath>

#include "rod/energy.h"
#include "rod/step.h"
#include "rod/test_oracle.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Random;
using fixtures::State;
using oracle::Real;

double Energy(const Strand& strand, const State& state) {
  return KineticEnergy(strand, state.velocity) + ElasticEnergy(strand, state.theta);
}

oracle::Matrix3X Columns(const std::vector<Vector3d>& vectors) {
  return oracle::Stack(vectors).reshaped(3, vectors.size());
}

// What (S8) says that a step from `before` to `after` adds to T + U on a clamp at rest.
double PredictedChange(const Strand& strand, const math::Pose& clamp, const Surroundings& air,
                       double dt, const State& before, const State& after) {
  const double gamma = air.internal_friction_scale * strand.internal_friction;
  const double nu = air.air_drag_scale * strand.air_drag;
  double change = 0;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    const double l = strand.length[Q];
    const Vector3d v = after.rate[Q];
    const Vector3d friction =
        (kLeastFriction * kTheta * dt * strand.stiffness).cwiseMax(Vector3d::Constant(gamma)) / l;
    change -= dt * v.dot(friction.cwiseProduct(v));
    change -= (kTheta - 0.5) * dt * dt * v.dot(strand.stiffness.cwiseProduct(v)) / l;
  }
  // With sum W_kl u_k.u_l for the mass times the squares of velocities (S12).
  const oracle::Rod rod(strand);
  const auto square = [&](const oracle::Matrix3X& u) {
    return static_cast<double>((u * rod.StepMasses()).cwiseProduct(u).sum());
  };
  const oracle::Matrix3X u = Columns(before.velocity), du = Columns(after.velocity) - u;
  change -= (kTheta - 0.5) * square(du);
  change -= dt * nu / strand.linear_density * square(u + kTheta * du);
  const oracle::Vector ahead =
      oracle::Stack(before.theta) + kTheta * dt * oracle::Stack(before.rate);
  const oracle::Frame frame = oracle::ToFrame(clamp);
  const oracle::Vector3 body = (air.gravity + nu / strand.linear_density * air.wind).cast<Real>();
  const oracle::Vector weight =
      rod.Gradient(frame, oracle::Vector3::Zero(), ahead) - rod.Gradient(frame, body, ahead);
  const oracle::Vector v = oracle::Stack(after.rate), last = oracle::Stack(before.rate);
  const Real h = kTheta * dt;
  const Real turning = dt * h * v.dot(rod.Turning(frame, body, ahead) * (v - last));
  return change + static_cast<double>(dt * weight.dot(v) - turning);
}

TEST(StepEnergyTest, ChangesByTheLawOfTheScheme) {
  Random random(2006);
  StepScratch scratch;
  for (const int N : {1, 2, 5}) {
    for (const double dt : {1e-4, 1.0 / 240, 1.0 / 30, 0.1, 1.0}) {
      const Strand strand = random.UnevenStrand(N, 0.2, 1);
      const math::Pose clamp = random.Pose();
      const State before = random.AnyState(strand, 0.5, 5, 1);
      Surroundings air;
      air.gravity = random.Vector(10);
      air.wind = random.Vector(3);
      air.air_drag_scale = 3;
      State after = before;
      ASSERT_TRUE(Step(strand, {clamp, clamp, dt}, air, after.View(), scratch));
      const double change = Energy(strand, after) - Energy(strand, before);
      const double predicted = PredictedChange(strand, clamp, air, dt, before, after);
      const double scale = Energy(strand, after) + Energy(strand, before);
      EXPECT_NEAR(change, predicted, 1e-10 * scale) << "N=" << N << " dt=" << dt;
    }
  }
}

TEST(StepEnergyTest, NeverGrowsOnAClampAtRestWithoutGravity) {
  Random random(55);
  StepScratch scratch;
  Surroundings air;
  air.gravity.setZero();
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    const int N = 1 + i % 8;
    Strand strand = i % 2 == 0
                        ? random.UnevenStrand(N, random.Uniform(0.05, 0.4), random.Uniform(0, 4))
                        : fixtures::MakeStrand(fixtures::AppendixB()[i / 2 % 4], 0.2, N);
    if (i % 3 == 0) {
      strand.internal_friction = 0;
      strand.air_drag = 0;
    }
    State state = random.AnyState(strand, 2, 30, 5);
    const math::Pose clamp = random.Pose();
    const double dt = std::pow(10, random.Uniform(-5, 1));
    double energy = Energy(strand, state);
    const double start = energy;
    for (int step = 0; step < 50; ++step) {
      ASSERT_TRUE(Step(strand, {clamp, clamp, dt}, air, state.View(), scratch));
      const double next = Energy(strand, state);
      ASSERT_LE(next, energy + 1e-11 * start) << "step " << step << " dt=" << dt;
      energy = next;
    }
  }
}

TEST(StepEnergyTest, IsConservedInTheLimitOfSmallSteps) {
  Strand strand = Random(21).UnevenStrand(2, 0.2, 2);
  strand.internal_friction = 0;
  strand.air_drag = 0;
  const math::Pose clamp;
  const Surroundings air;
  const auto drift = [&](int steps) {
    State state(strand);
    StepScratch scratch;
    const auto total = [&] {
      return Energy(strand, state) + GravityPotential(strand, clamp, air.gravity, state.theta);
    };
    const double start = total();
    for (int i = 0; i < steps; ++i) {
      EXPECT_TRUE(Step(strand, {clamp, clamp, 0.2 / steps}, air, state.View(), scratch));
    }
    return (total() - start) / KineticEnergy(strand, state.velocity);
  };
  const double a = drift(4000), b = drift(8000), c = drift(16000);
  // First order, as theta is not one half: halves with the step, and the extrapolation is nothing.
  EXPECT_LT(b, 0);
  EXPECT_NEAR(b / c, 2, 0.1);
  const double first = 2 * b - a, second = 2 * c - b;
  EXPECT_LT(std::abs((4 * second - first) / 3), 0.002 * std::abs(c));
}

}  // namespace
}  // namespace mane::rod
