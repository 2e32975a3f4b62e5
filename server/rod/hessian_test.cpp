// Properties of the linearised potential:
//   twins        energy and gradient are those of energy.h, the Hessian the gradient's difference
//   elimination  solves what the dense matrix solves, and judges definiteness as it does
//   eigenvalue   the lowest one is the dense one, its mode an eigenvector
//   Greenhill    an upright column's lowest eigenvalue crosses zero at the critical number

#include "rod/hessian.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <cmath>

#include "rod/energy.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using fixtures::Random;

// A heavy strand of three stiffnesses at angles far from its natural ones.
struct Case {
  Strand strand;
  math::Pose clamp;
  Vector3d gravity;
  std::vector<Vector3d> theta;

  Case(Random& random, int elements, double angle)
      : strand(random.UnevenStrand(elements, 0.2, 0.5)),
        clamp(random.Pose()),
        gravity(9.81 * random.Direction()),
        theta(random.Vectors(elements, angle)) {}

  [[nodiscard]] PotentialHessian Linearized() const {
    PotentialHessian hessian;
    hessian.Linearize(strand, clamp, gravity, theta);
    return hessian;
  }
  [[nodiscard]] VectorXd Metric() const {
    VectorXd D(3 * strand.elements());
    for (int Q = 0; Q < strand.elements(); ++Q) {
      D.segment<3>(3 * Q) = strand.stiffness / strand.length[Q];
    }
    return D;
  }
};

VectorXd Stack(std::span<const Vector3d> v) {
  return Eigen::Map<const VectorXd>(v[0].data(), 3 * static_cast<Eigen::Index>(v.size()));
}

TEST(HessianTest, EnergyAndGradientAreThoseOfTheEnergy) {
  Random random(801);
  for (const double angle : {0.0, 1e-7, 0.1, 1.9, 2.1, 8.0}) {
    for (const int N : {1, 2, 7}) {
      const Case c(random, N, angle);
      const PotentialHessian hessian = c.Linearized();
      const double energy = ElasticEnergy(c.strand, c.theta) +
                            GravityPotential(c.strand, c.clamp, c.gravity, c.theta);
      EXPECT_NEAR(hessian.energy(), energy, 1e-13 * (std::abs(energy) + 1e-6));
      std::vector<Vector3d> gradient(N);
      PotentialGradient(c.strand, c.clamp, c.gravity, c.theta, gradient);
      const VectorXd expected = Stack(gradient);
      EXPECT_LT((Stack(hessian.gradient()) - expected).norm(), 1e-12 * expected.norm());
    }
  }
}

TEST(HessianTest, IsTheDerivativeOfTheGradient) {
  Random random(802);
  constexpr double kStep = 1e-5;  // rad; differences are good to about 1e-9 of the Hessian.
  for (const double angle : {0.0, 1e-7, 0.1, 1.1, 1.3, 3.0, 8.0}) {
    for (const int N : {1, 2, 5}) {
      Case c(random, N, angle);
      const MatrixXd H = c.Linearized().Dense();
      MatrixXd differences(3 * N, 3 * N);
      for (int j = 0; j < 3 * N; ++j) {
        const auto gradient_at = [&](double step) {
          std::vector<Vector3d> theta = c.theta, gradient(N);
          theta[j / 3][j % 3] += step;
          PotentialGradient(c.strand, c.clamp, c.gravity, theta, gradient);
          return Stack(gradient);
        };
        differences.col(j) = (gradient_at(kStep) - gradient_at(-kStep)) / (2 * kStep);
      }
      EXPECT_LT((H - differences).norm(), 2e-9 * H.norm()) << N << " " << angle;
    }
  }
}

TEST(HessianTest, EliminationSolvesWhatTheDenseMatrixSolves) {
  Random random(803);
  int definite = 0, indefinite = 0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const int N = 1 + i % 12;
    const Case c(random, N, random.Uniform(0, 3));
    PotentialHessian hessian = c.Linearized();
    const double shift = random.Uniform(0, 3);
    const MatrixXd shifted = hessian.Dense() + shift * MatrixXd(c.Metric().asDiagonal());
    const Eigen::LLT<MatrixXd> llt(shifted);
    ASSERT_EQ(hessian.Factor(shift), llt.info() == Eigen::Success);
    if (llt.info() != Eigen::Success) {
      ++indefinite;
      continue;
    }
    ++definite;
    std::vector<Vector3d> x = random.Vectors(N, 1);
    const VectorXd b = Stack(x);
    hessian.Solve(x, x);
    EXPECT_LT((shifted * Stack(x) - b).norm(), 1e-10 * b.norm());
  }
  EXPECT_GT(definite, 5);
  EXPECT_GT(indefinite, 5);
}

TEST(HessianTest, LowestEigenvalueIsTheDenseOne) {
  Random random(804);
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const int N = 1 + i % 12;
    const Case c(random, N, random.Uniform(0, 3));
    PotentialHessian hessian = c.Linearized();
    const MatrixXd H = hessian.Dense(), D = c.Metric().asDiagonal();
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(H, D);
    std::vector<Vector3d> mode(N);
    const double lambda = hessian.LowestEigenvalue(mode), expected = modes.eigenvalues()[0];
    EXPECT_NEAR(lambda, expected, 1e-8 * (1 + std::abs(expected)));
    const VectorXd x = Stack(mode);
    EXPECT_DOUBLE_EQ(x.cwiseAbs().maxCoeff(), 1);
    EXPECT_LT((H * x - lambda * D * x).norm(), 1e-3 * (D * x).norm() * (1 + std::abs(lambda)));
  }
}

TEST(HessianTest, UprightColumnLosesStabilityAtGreenhillsNumber) {
  const math::Pose upright{
      Vector3d::Zero(), Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), Vector3d::UnitY())};
  std::vector<double> error;
  for (const int N : {5, 10, 20}) {
    double low = 1, high = 20;  // Of rho S g L^3 / EI, where the eigenvalue changes its sign.
    while (high - low > 1e-9) {
      const double number = 0.5 * (low + high);
      const Strand strand = fixtures::HeavyStrand(number, N);
      PotentialHessian hessian;
      hessian.Linearize(strand, upright, {0, -9.81, 0}, std::vector<Vector3d>(N, Vector3d::Zero()));
      (hessian.LowestEigenvalue({}) > 0 ? low : high) = number;
    }
    error.push_back(low / 7.837347 - 1);
  }
  // Second order in the number of elements.
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.05);
  EXPECT_NEAR(std::log2(error[1] / error[2]), 2, 0.05);
  EXPECT_LT(error[2], 1e-3);
}

}  // namespace
}  // namespace mane::rod
