// Properties of a wound strand's linearised potential:
//   twins        energy is that of wound_shape.h, the gradient its difference, the Hessian that of
//                the gradient
//   elimination  solves what the dense matrix solves, and judges definiteness as it does
//   eigenvalue   the lowest one is the dense one, its mode an eigenvector

#include "rod/wound_hessian.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <cmath>

#include "rod/test_wound.h"
#include "rod/wound_shape.h"

namespace mane::rod {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using fixtures::Random;
using fixtures::WoundOwned;

// A heavy wound strand at unknowns far from its natural ones.
struct Case {
  WoundStrand wound;
  math::Pose clamp;
  Vector3d gravity;
  std::vector<Vector4d> x;

  Case(Random& random, int elements, double turns, double off)
      : wound(fixtures::AnyWound(random, elements, 0.2, turns)),
        clamp(random.Pose()),
        gravity(9.81 * random.Direction()),
        x(WoundOwned(wound, random, off, 0, 0).x) {}

  [[nodiscard]] WoundHessian At(const std::vector<Vector4d>& unknowns) const {
    WoundHessian hessian;
    hessian.Linearize(wound, clamp, gravity, unknowns);
    return hessian;
  }
};

VectorXd Stack(std::span<const Vector4d> v) {
  return Eigen::Map<const VectorXd>(v[0].data(), 4 * static_cast<Eigen::Index>(v.size()));
}

TEST(WoundHessianTest, EnergyIsThatOfTheShape) {
  Random random(811);
  for (const int N : {1, 2, 7}) {
    const Case c(random, N, 10, 1);
    const double energy =
        ElasticEnergy(c.wound, c.x) + GravityPotential(c.wound, c.clamp, c.gravity, c.x);
    EXPECT_NEAR(c.At(c.x).energy(), energy, 1e-13 * (std::abs(energy) + 1e-6));
  }
}

TEST(WoundHessianTest, GradientAndHessianAgreeWithFiniteDifferences) {
  Random random(812);
  constexpr double kStep = 1e-5;  // rad
  for (const double turns : {1.0, 10.0, 60.0}) {
    for (const double off : {1e-7, 0.1, 1.0, 4.0}) {
      for (const int N : {1, 3, 8}) {
        const Case c(random, N, turns, off);
        const WoundHessian here = c.At(c.x);
        const VectorXd gradient = Stack(here.gradient());
        const MatrixXd H = here.Dense();
        MatrixXd differences(4 * N, 4 * N);
        VectorXd slopes(4 * N);
        for (int j = 0; j < 4 * N; ++j) {
          std::vector<Vector4d> low = c.x, high = c.x;
          low[j / 4][j % 4] -= kStep;
          high[j / 4][j % 4] += kStep;
          const WoundHessian below = c.At(low), above = c.At(high);
          slopes[j] = (above.energy() - below.energy()) / (2 * kStep);
          differences.col(j) = (Stack(above.gradient()) - Stack(below.gradient())) / (2 * kStep);
        }
        SCOPED_TRACE(testing::Message() << turns << " turns, off " << off << ", N=" << N);
        // Rounding of the energy, of order 1e-16 over the step.
        const double rounding = 1e-10 * (std::abs(here.energy()) + 1e-6);
        EXPECT_LT((gradient - slopes).norm(), 1e-7 * gradient.norm() + rounding);
        EXPECT_LT((H - differences).norm(), 5e-9 * H.norm());
      }
    }
  }
}

TEST(WoundHessianTest, EliminationSolvesWhatTheDenseMatrixSolves) {
  Random random(813);
  int definite = 0, indefinite = 0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const int N = 1 + i % 12;
    Case c(random, N, random.Uniform(2, 30), random.Uniform(0, 0.6));
    c.gravity *= random.Uniform(0, 4);
    WoundHessian hessian = c.At(c.x);
    const MatrixXd D = Stack(hessian.metric()).asDiagonal(), H = hessian.Dense();
    const double shift = random.Uniform(0, 3);
    const Eigen::LLT<MatrixXd> llt(H + shift * D);
    ASSERT_EQ(hessian.Factor(shift), llt.info() == Eigen::Success);
    if (llt.info() == Eigen::Success) {
      ++definite;
      std::vector<Vector4d> x = WoundOwned(c.wound, random, 1, 0, 0).x;
      const VectorXd b = Stack(x);
      hessian.Solve(x, x);
      EXPECT_LT(((H + shift * D) * Stack(x) - b).norm(), 1e-10 * b.norm());
    } else {
      ++indefinite;
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(H, D);
    std::vector<Vector4d> mode(N);
    const double lambda = hessian.LowestEigenvalue(mode), expected = modes.eigenvalues()[0];
    EXPECT_NEAR(lambda, expected, 1e-8 * (1 + std::abs(expected)));
    const VectorXd x = Stack(mode);
    EXPECT_DOUBLE_EQ(x.cwiseAbs().maxCoeff(), 1);
    EXPECT_LT((H * x - lambda * D * x).norm(), 1e-3 * (D * x).norm() * (1 + std::abs(lambda)));
  }
  EXPECT_GT(definite, 5);
  EXPECT_GT(indefinite, 5);
}

}  // namespace
}  // namespace mane::rod
