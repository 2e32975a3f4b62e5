// Properties of the static equilibrium:
//   elastica    converges, second order in the number of elements, to the planar heavy elastica,
//               solved here as a boundary value problem
//   graded      with graded element lengths its tip is off by a tenth of that
//   minimum     no small change of the angles lowers the energy
//   buckling    an upright straight strand leaves its saddle above Greenhill's number, and only
//   there natural     without gravity the natural shape of every hair type is the rest shape
//   symmetry    turning clamp and gravity together turns the answer
//   any start   every hair type comes to rest from far off its natural shape, in any pose
//   many        256 elements come to rest, where 128 do up to the error of second order

#include "rod/statics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "rod/energy.h"
#include "rod/graded_lengths.h"
#include "rod/hessian.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::kGravity;
using fixtures::kL;
using fixtures::Random;
using fixtures::State;
using fixtures::Tip;

// Tip of a strand of unit length, clamped horizontally, of gravito-bending number `number`: with t
// from the tip and chi the angle of the tangent from straight down,
//
//     chi'' = number t sin chi,   chi'(0) = 0,   chi(1) = pi/2.
//
// Shooting from the tip, where chi(0) is found by bisection, with RK4.
class HeavyElastica {
 public:
  explicit HeavyElastica(double number) : number_(number) {
    double low = -40, high = std::log(M_PI / 2);  // Of the logarithm of chi(0).
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      (Shoot(std::exp(middle))[0] < M_PI / 2 ? low : high) = middle;
    }
    const std::array<double, 4> end = Shoot(std::exp(low));
    across_ = end[2];
    down_ = end[3];
  }
  [[nodiscard]] double across() const { return across_; }
  [[nodiscard]] double down() const { return down_; }

 private:
  // (chi, chi', how far across, how far down) at the clamp.
  [[nodiscard]] std::array<double, 4> Shoot(double chi) const {
    const int steps = 2000;
    const double h = 1.0 / steps;
    Eigen::Vector4d y(chi, 0, 0, 0);
    const auto slope = [&](double t, const Eigen::Vector4d& x) {
      return Eigen::Vector4d(x[1], number_ * t * std::sin(x[0]), std::sin(x[0]), std::cos(x[0]));
    };
    for (int i = 0; i < steps && y[0] < M_PI; ++i) {
      const double t = i * h;
      const Eigen::Vector4d a = slope(t, y), b = slope(t + h / 2, y + h / 2 * a),
                            c = slope(t + h / 2, y + h / 2 * b), d = slope(t + h, y + h * c);
      y += h / 6 * (a + 2 * b + 2 * c + d);
    }
    return {y[0], y[1], y[2], y[3]};
  }

  double number_, across_ = 0, down_ = 0;
};

TEST(StaticsTest, ElasticaOfThisTestHasTheKnownTips) {
  // Small deflection: a uniformly loaded cantilever sags by number / 8 of its length.
  EXPECT_NEAR(HeavyElastica(1e-3).down() / (1e-3 / 8), 1, 1e-5);
  // L = 0.2 m, radius 35 um, E = 4 GPa, 1300 kg/m^3.
  const double number = 4 * 1300 * 9.81 * std::pow(0.2, 3) / (4e9 * std::pow(35e-6, 2));
  EXPECT_NEAR(number, 83.28, 0.01);
  EXPECT_NEAR(1e3 * kL * HeavyElastica(number).across(), 35.540, 6e-4);
  EXPECT_NEAR(1e3 * kL * HeavyElastica(number).down(), 186.197, 6e-4);
}

TEST(StaticsTest, ConvergesToTheHeavyElasticaAtSecondOrder) {
  for (const double number : {1.0, 163.24, 551.0}) {
    const HeavyElastica exact(number);
    const Vector3d tip(kL * exact.across(), -kL * exact.down(), 0);
    std::vector<double> error;
    for (const int N : {1, 2, 5, 10, 20}) {
      const Strand strand = fixtures::HeavyStrand(number, N);
      State state(strand);
      const StaticsReport report = SolveRestShape(strand, {}, kGravity, state.theta);
      EXPECT_TRUE(report.converged) << report.residual;
      EXPECT_LE(report.residual, 1e-9);
      error.push_back((Tip(strand, {}, state.theta) - tip).norm() / kL);
      for (const Vector3d& theta : state.theta) {  // Planar: bent about n2 alone.
        EXPECT_LT(std::hypot(theta.x(), theta.y()), 1e-9);
      }
      if (error.size() > 1) {
        EXPECT_LT(error.back(), error[error.size() - 2]);
      }
    }
    SCOPED_TRACE(number);
    EXPECT_NEAR(std::log2(error[3] / error[4]), 2, 0.15);
    EXPECT_LT(error[4], number < 100 ? 2e-4 : number < 200 ? 2e-3 : 4e-3);
  }
}

TEST(StaticsTest, GradedLengthsCutTheErrorOfHeavyHairTenfold) {
  struct Case {
    double number;
    int N;
    double at_most;  // Distance of the tip over L.
  };
  // Number 163 is smooth hair of 20 cm; equal lengths are off by 3.1 and 0.79 %.
  for (const Case& c : {Case{163.24, 5, 2e-3}, Case{163.24, 10, 5e-4}, Case{20, 5, 4e-3},
                        Case{551, 5, 3e-3}, Case{551, 10, 5e-4}, Case{2000, 10, 5e-4}}) {
    const HeavyElastica exact(c.number);
    const Vector3d tip(kL * exact.across(), -kL * exact.down(), 0);
    Strand strand = fixtures::HeavyStrand(c.number, c.N);
    strand.length = GradedLengths(
        {.length = kL, .stiffness = strand.stiffness[2], .linear_density = strand.linear_density},
        c.N);
    State state(strand);
    EXPECT_TRUE(SolveRestShape(strand, {}, kGravity, state.theta).converged);
    EXPECT_LT((Tip(strand, {}, state.theta) - tip).norm() / kL, c.at_most)
        << c.number << " " << c.N;
  }
}

TEST(StaticsTest, EnergyIsAtAMinimum) {
  Random random(61);
  for (const fixtures::Hair& hair : fixtures::AppendixB()) {
    for (const double length : {0.1, 0.2}) {
      const Strand strand = fixtures::MakeStrand(hair, length, 5);
      const math::Pose clamp = random.Pose();
      State state(strand);
      const StaticsReport report = SolveRestShape(strand, clamp, kGravity, state.theta);
      EXPECT_TRUE(report.converged) << hair.name << " " << length << " " << report.residual;
      const auto energy = [&](const std::vector<Vector3d>& theta) {
        return ElasticEnergy(strand, theta) + GravityPotential(strand, clamp, kGravity, theta);
      };
      const double least = energy(state.theta);
      for (int i = 0; i < 100; ++i) {
        std::vector<Vector3d> moved = state.theta;
        for (Vector3d& theta : moved) theta += random.Vector(3e-3);
        EXPECT_GT(energy(moved), least) << hair.name << " " << length;
      }
    }
  }
}

TEST(StaticsTest, UprightStrandBucklesAboveGreenhillsNumberOnly) {
  // 7.8373 for the continuous column; ten elements are stiffer by less than one percent.
  const math::Pose upright = fixtures::Upright();
  for (const double number : {2.0, 7.5, 8.2, 20.0, 163.0}) {
    const Strand strand = fixtures::HeavyStrand(number, 10);
    State state(strand);
    const StaticsReport report = SolveRestShape(strand, upright, kGravity, state.theta);
    EXPECT_TRUE(report.converged) << number;
    const Vector3d tip = Tip(strand, upright, state.theta);
    if (number < 7.8) {
      EXPECT_LT((tip - Vector3d(0, kL, 0)).norm(), 1e-9) << number;
    } else {
      EXPECT_GT((tip - Vector3d(0, kL, 0)).norm(), 0.2 * kL) << number;
      const double straight = GravityPotential(strand, upright, kGravity, State(strand).theta);
      EXPECT_LT(ElasticEnergy(strand, state.theta) +
                    GravityPotential(strand, upright, kGravity, state.theta),
                straight - 1e-3 * std::abs(straight))
          << number;
    }
  }
}

TEST(StaticsTest, NaturalShapeIsTheRestShapeWithoutGravity) {
  Random random(62);
  for (const fixtures::Hair& hair : fixtures::AppendixB()) {
    for (const double length : {0.1, 0.2, 0.3}) {
      const Strand strand = fixtures::MakeStrand(hair, length, 7);
      State state(strand);
      for (Vector3d& theta : state.theta) theta += random.Vector(0.5);
      const StaticsReport report = SolveRestShape(strand, {}, Vector3d::Zero(), state.theta);
      EXPECT_TRUE(report.converged) << hair.name;
      for (int Q = 0; Q < 7; ++Q) {
        EXPECT_LT((state.theta[Q] - State(strand).theta[Q]).norm(), 1e-6) << hair.name;
      }
    }
  }
}

TEST(StaticsTest, TurningClampAndGravityTurnsTheAnswer) {
  Random random(63);
  const Strand strand = fixtures::MakeStrand(fixtures::AppendixB()[1], 0.2, 5);
  const math::Pose clamp = random.Pose(), turn = random.Pose();
  State a(strand), b(strand);
  EXPECT_TRUE(SolveRestShape(strand, clamp, kGravity, a.theta).converged);
  EXPECT_TRUE(SolveRestShape(strand, turn * clamp, turn.q * kGravity, b.theta).converged);
  for (int Q = 0; Q < 5; ++Q) EXPECT_LT((a.theta[Q] - b.theta[Q]).norm(), 1e-6);
}

TEST(StaticsTest, ComesToRestFromAnyStart) {
  Random random(64);
  for (int i = 0; i < 400; ++i) {
    const fixtures::Hair& hair = fixtures::AppendixB()[i % 4];
    const int N = 5 + i % 16;
    const Strand strand = fixtures::MakeStrand(hair, random.Uniform(0.05, 0.3), N);
    State state(strand);
    for (Vector3d& theta : state.theta) theta += random.Vector(1);
    const StaticsReport report = SolveRestShape(strand, random.Pose(), kGravity, state.theta);
    EXPECT_TRUE(report.converged) << i << " " << hair.name << " " << report.residual;
    EXPECT_LT(report.iterations, 150) << i << " " << hair.name;
  }
}

TEST(StaticsTest, ManyElementsComeToRest) {
  const math::Pose clamp = Random(65).Pose();
  std::vector<Vector3d> tips;
  for (const int N : {64, 128, 256}) {
    const Strand strand = fixtures::MakeStrand(fixtures::AppendixB()[1], 0.2, N);
    State state(strand);
    EXPECT_TRUE(SolveRestShape(strand, clamp, kGravity, state.theta).converged) << N;
    tips.push_back(Tip(strand, clamp, state.theta));
  }
  EXPECT_LT((tips[2] - tips[1]).norm(), 2e-4 * kL);
  EXPECT_NEAR(std::log2((tips[1] - tips[0]).norm() / (tips[2] - tips[1]).norm()), 2, 0.2);
}

TEST(StaticsTest, ASaddleIsLeftThoughRoundingKeepsTheResidualAboveTheTolerance) {
  // Straight down, bent about both axes: by symmetry the descent ends on a saddle.
  for (const int N : {3, 4, 5, 6, 8}) {
    Strand strand = fixtures::MakeStrand(fixtures::AppendixB()[0], 0.1, N);
    for (Vector3d& natural : strand.natural) natural = {0, 20, 60};
    const math::Pose down{Vector3d::Zero(),
                          Eigen::Quaterniond(Eigen::AngleAxisd(-M_PI / 2, Vector3d::UnitZ()))};
    std::vector<Vector3d> theta(N);
    for (int Q = 0; Q < N; ++Q) theta[Q] = strand.length[Q] * strand.natural[Q];
    (void)SolveRestShape(strand, down, {0, -9.81, 0}, theta);
    PotentialHessian hessian;
    hessian.Linearize(strand, down, {0, -9.81, 0}, theta);
    EXPECT_TRUE(hessian.Factor(1e-6)) << N;
  }
}

}  // namespace
}  // namespace mane::rod
