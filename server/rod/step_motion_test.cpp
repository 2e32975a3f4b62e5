// Trajectories of the time step against other ways to get them:
//   Lagrange       converge, first order in dt, to an RK4 integration of [SH06] (4) built from
//   finite
//                  differences, for clamps at rest, moving and turning, with friction, drag and
//                  wind
//   moving frame   on a clamp that accelerates evenly it moves as on a fixed one under g - a
//   settling       comes to rest where SolveRestShape says, and stays there
//   wind           steady wind acts as the weight nu w / (rho S), drag included

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "rod/chain.h"
#include "rod/statics.h"
#include "rod/step.h"
#include "rod/test_oracle.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Random;
using fixtures::State;
using oracle::Frame;
using oracle::Real;
using oracle::Vector;

struct Scene {
  Strand strand;
  std::function<Frame(Real)> clamp;
  Surroundings air;
  double duration;
};

Frame RestingClamp(Real) { return {}; }

// Swings along a curve while it turns about one axis to and fro and about another steadily.
Frame WildClamp(Real t) {
  const Real a = 0.9L * std::sin(5 * t), b = 2 * t;
  oracle::Matrix3 yaw, roll;
  yaw << std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a);
  roll << 1, 0, 0, 0, std::cos(b), -std::sin(b), 0, std::sin(b), std::cos(b);
  return {yaw * roll, {0.1L * std::sin(6 * t), 0.05L * t, 0.08L * (1 - std::cos(4 * t))}};
}

math::Pose ToPose(const Frame& frame) {
  return {frame.r.cast<double>(), Eigen::Quaterniond(frame.n.cast<double>()).normalized()};
}

// Angles and rates from which a scene starts, and the state that the step starts from.
oracle::Motion StartMotion(const Scene& scene) {
  Random random(8);
  const int N = scene.strand.elements();
  return {oracle::Rod(scene.strand).Natural() + oracle::Stack(random.Vectors(N, 0.3)),
          oracle::Stack(random.Vectors(N, 3))};
}

// Angles at the end after `steps` steps.
Vector RunSteps(const Scene& scene, int steps) {
  const oracle::Motion start = StartMotion(scene);
  State state(scene.strand);
  for (int Q = 0; Q < scene.strand.elements(); ++Q) {
    state.theta[Q] = start.theta.segment<3>(3 * Q).cast<double>();
    state.rate[Q] = start.rate.segment<3>(3 * Q).cast<double>();
  }
  const oracle::Matrix3X u =
      oracle::PointVelocities(scene.strand, scene.clamp, 0, start, oracle::GaussRule(kGaussPoints));
  for (size_t k = 0; k < state.velocity.size(); ++k) state.velocity[k] = u.col(k).cast<double>();
  const double dt = scene.duration / steps;
  StepScratch scratch;
  for (int i = 0; i < steps; ++i) {
    const ClampMotion motion{ToPose(scene.clamp(i * static_cast<Real>(dt))),
                             ToPose(scene.clamp((i + 1) * static_cast<Real>(dt))), dt};
    EXPECT_TRUE(Step(scene.strand, motion, scene.air, state.View(), scratch));
  }
  return oracle::Stack(state.theta);
}

void ExpectConvergesToLagrange(const Scene& scene) {
  // Its own error, by halving its step: 1e-9.
  const Vector exact = oracle::IntegrateLagrange(scene.strand, scene.clamp, scene.air,
                                                 StartMotion(scene), scene.duration, 400)
                           .theta;
  const Vector moved = exact - StartMotion(scene).theta;
  Vector x[4];
  double error[4];
  for (int i = 0; i < 4; ++i) {
    x[i] = RunSteps(scene, 1000 << i);
    error[i] = static_cast<double>((x[i] - exact).norm() / moved.norm());
  }
  EXPECT_LT(error[3], 5e-3);
  const double order = std::log2(error[2] / error[3]);
  EXPECT_GT(order, 0.9);
  EXPECT_LT(order, 1.6);
  // Romberg's extrapolation to dt = 0 of a first order method.
  const Vector first[3] = {2 * x[1] - x[0], 2 * x[2] - x[1], 2 * x[3] - x[2]};
  const Vector second[2] = {(4 * first[1] - first[0]) / 3, (4 * first[2] - first[1]) / 3};
  const Vector limit = (8 * second[1] - second[0]) / 7;
  EXPECT_LT(static_cast<double>((limit - exact).norm() / moved.norm()), 0.02 * error[3])
      << "errors " << error[0] << " " << error[1] << " " << error[2] << " " << error[3];
}

Scene MakeScene(int N, std::function<Frame(Real)> clamp) {
  Scene scene{Random(7).UnevenStrand(N, 0.2, 2), std::move(clamp), {}, 0.2};
  scene.strand.internal_friction = 0;
  scene.strand.air_drag = 0;
  return scene;
}

TEST(StepMotionTest, FreeFallOnARestingClampFollowsLagrange) {
  ExpectConvergesToLagrange(MakeScene(1, RestingClamp));
  ExpectConvergesToLagrange(MakeScene(2, RestingClamp));
}

TEST(StepMotionTest, MovingAndTurningClampFollowsLagrange) {
  ExpectConvergesToLagrange(MakeScene(1, WildClamp));
  ExpectConvergesToLagrange(MakeScene(2, WildClamp));
}

TEST(StepMotionTest, FrictionDragAndWindFollowLagrange) {
  Scene scene = MakeScene(2, WildClamp);
  scene.strand.internal_friction = 5e-11;
  scene.strand.air_drag = 4e-5;
  scene.air.wind = {1, 0.5, -2};
  scene.air.internal_friction_scale = 0.7;
  scene.air.air_drag_scale = 1.3;
  ExpectConvergesToLagrange(scene);
}

// Largest distance of angles between a clamp at rest under the weight -a and one that is
// accelerated by a, over half a second of steps of `dt`.
double WeightAgainstAcceleration(const Strand& strand, double dt, double* moved) {
  const Vector3d a(4, -3, 6);
  const math::Pose root{{0.1, 0.2, 0.3}, Random(32).Rotation()};
  State fixed(strand), moving(strand);
  // The step averages the clamp's velocity, so a velocity field that starts at a dt (1/2 - theta)
  // is at rest in the clamp's frame.
  for (Vector3d& u : moving.velocity) u += a * dt * (0.5 - kTheta);
  Surroundings still, carried;
  still.gravity -= a;
  StepScratch scratch;
  double largest = 0;
  for (int i = 0; i * dt < 0.5; ++i) {
    ClampMotion motion{root, root, dt};
    EXPECT_TRUE(Step(strand, motion, still, fixed.View(), scratch));
    motion.begin.p += 0.5 * a * (i * dt) * (i * dt);
    motion.end.p += 0.5 * a * ((i + 1) * dt) * ((i + 1) * dt);
    carried.wind = (motion.end.p - motion.begin.p) / dt;  // The air rides along.
    EXPECT_TRUE(Step(strand, motion, carried, moving.View(), scratch));
    for (int Q = 0; Q < strand.elements(); ++Q) {
      largest = std::max(largest, (fixed.theta[Q] - moving.theta[Q]).norm());
      *moved = std::max(*moved, (fixed.theta[Q] - State(strand).theta[Q]).norm());
    }
  }
  return largest;
}

TEST(StepMotionTest, EvenlyAcceleratedClampIsWeight) {
  // Both runs agree but for the part of weight that is implicit (S9), which is of order dt.
  const Strand strand = Random(31).UnevenStrand(5, 0.2, 0.5);
  double moved = 0;
  const double coarse = WeightAgainstAcceleration(strand, 1.0 / 2000, &moved);
  const double fine = WeightAgainstAcceleration(strand, 1.0 / 8000, &moved);
  EXPECT_GT(moved, 0.1);
  EXPECT_LT(fine, 0.01 * moved);
  EXPECT_GT(coarse, 3 * fine);
}

std::vector<Vector3d> Shape(const Strand& strand, const math::Pose& clamp,
                            const std::vector<Vector3d>& theta) {
  std::vector<Vector3d> points;
  for (int i = 0; i <= 20; ++i) {
    points.push_back(
        PointAt(strand, clamp, theta, Locate(strand, strand.TotalLength() * i / 20)).r);
  }
  return points;
}

double Distance(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

// Steps until the strand has come to rest in air that is far stickier than real.
void Settle(const Strand& strand, const math::Pose& clamp, const Surroundings& air, State* state) {
  StepScratch scratch;
  for (int i = 0; i < 6000; ++i) {
    ASSERT_TRUE(Step(strand, {clamp, clamp, 1.0 / 60}, air, state->View(), scratch));
  }
}

TEST(StepMotionTest, SettlesInTheStaticEquilibriumAndStaysThere) {
  Random random(41);
  for (const fixtures::Hair& hair : fixtures::AppendixB()) {
    SCOPED_TRACE(hair.name);
    const Strand strand = fixtures::MakeStrand(hair, 0.2, 5);
    const math::Pose clamp = random.Pose();
    Surroundings air;
    air.air_drag_scale = 20;
    State state(strand);
    Settle(strand, clamp, air, &state);
    State still(strand);
    still.theta = state.theta;
    const StaticsReport report = SolveRestShape(strand, clamp, air.gravity, still.theta);
    EXPECT_TRUE(report.converged);
    const auto rest = Shape(strand, clamp, still.theta);
    EXPECT_LT(Distance(Shape(strand, clamp, state.theta), rest), 1e-6 * 0.2);

    // From that shape nothing moves, without any drag to hold it.
    StepScratch scratch;
    air.air_drag_scale = 0;
    for (int i = 0; i < 300; ++i) {
      ASSERT_TRUE(Step(strand, {clamp, clamp, 1.0 / 60}, air, still.View(), scratch));
    }
    EXPECT_LT(Distance(Shape(strand, clamp, still.theta), rest), 1e-7 * 0.2);
  }
}

TEST(StepMotionTest, NaturalShapeStaysPutWithoutGravity) {
  for (const fixtures::Hair& hair : fixtures::AppendixB()) {
    const Strand strand = fixtures::MakeStrand(hair, 0.2, 5);
    Surroundings air;
    air.gravity.setZero();
    State state(strand);
    StepScratch scratch;
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(Step(strand, {{}, {}, 1.0 / 60}, air, state.View(), scratch));
    }
    for (int Q = 0; Q < 5; ++Q) {
      EXPECT_LT((state.theta[Q] - State(strand).theta[Q]).norm(), 1e-12) << hair.name;
    }
  }
}

TEST(StepMotionTest, SteadyWindIsWeight) {
  Random random(43);
  const Strand strand = fixtures::MakeStrand(fixtures::AppendixB()[1], 0.2, 5);
  const math::Pose clamp = random.Pose();
  Surroundings air;
  air.wind = {0.9, 0.1, -0.5};
  air.air_drag_scale = 20;
  State state(strand);
  Settle(strand, clamp, air, &state);
  std::vector<Vector3d> theta = state.theta;
  const Vector3d weight = air.gravity + 20 * strand.air_drag / strand.linear_density * air.wind;
  EXPECT_TRUE(SolveRestShape(strand, clamp, weight, theta).converged);
  EXPECT_LT(Distance(Shape(strand, clamp, state.theta), Shape(strand, clamp, theta)), 1e-6 * 0.2);
  EXPECT_GT(weight.cross(air.gravity).norm(), 10 * air.gravity.norm());  // It does blow.
}

}  // namespace
}  // namespace mane::rod
