// Properties of the chain of elements, equal and unequal, clamped anywhere:
//   reference    frames and points agree with the oracle
//   Jacobian     agrees with finite differences; zero beyond the point's element
//   C1           point and tangent are continuous where elements meet
//   length       polylines are never longer than the strand and tend to its length
//   mass         agrees with brute force; positive semidefinite; does not see the clamp
//   arc length   Locate inverts the sum of lengths

#include "rod/chain.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "base/check_failure.h"
#include "rod/scheme.h"
#include "rod/test_oracle.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using oracle::Real;

struct Case {
  Strand strand;
  math::Pose clamp;
  std::vector<Vector3d> theta;
};

// Random chains of N elements bent by up to `angle` a component.
Case MakeCase(int N, double angle, uint64_t seed) {
  fixtures::Random random(seed);
  Case c;
  c.strand = random.UnevenStrand(N, 0.3, 1);
  c.clamp = random.Pose();
  c.theta = random.Vectors(N, angle);
  return c;
}

const int kSizes[] = {1, 2, 5, 10, 20};

TEST(ChainTest, FramesAndPointsAgreeWithTheOracle) {
  for (const int N : kSizes) {
    for (const double angle : {0.0, 1e-6, 1.0, 10.0}) {
      const Case c = MakeCase(N, angle, N);
      const oracle::Rod rod(c.strand);
      const oracle::Frame clamp = oracle::ToFrame(c.clamp);
      const std::vector<ElementFrame> frames = ElementFrames(c.strand, c.clamp, c.theta);
      ASSERT_EQ(frames.size(), static_cast<size_t>(N + 1));
      // Each element's rounding turns all beyond it.
      const double tolerance = 4e-15 * (1 + angle) * N;
      for (int Q = 0; Q < N; ++Q) {
        const oracle::Frame right = rod.At(clamp, oracle::Stack(c.theta), Q, 1);
        EXPECT_LT((frames[Q + 1].R - right.n.cast<double>()).norm(), tolerance);
        EXPECT_LT((frames[Q + 1].r - right.r.cast<double>()).norm(), tolerance);
        EXPECT_LT((frames[Q].R.transpose() * frames[Q].R - Eigen::Matrix3d::Identity()).norm(),
                  tolerance);
        const Vector3d r = rod.At(clamp, oracle::Stack(c.theta), Q, 0.3L).r.cast<double>();
        EXPECT_LT((PointAt(c.strand, c.clamp, c.theta, {Q, 0.3}).r - r).norm(), tolerance);
      }
    }
  }
}

TEST(ChainTest, PointJacobianAgreesWithFiniteDifferences) {
  for (const int N : {1, 2, 5}) {
    for (const double angle : {0.0, 1e-6, 1.0, 10.0}) {
      const Case c = MakeCase(N, angle, 10 + N);
      const oracle::Rule rule{{0.0L, 0.31L, 1.0L}, {0, 0, 0}};
      const std::vector<oracle::Matrix3X> J =
          oracle::Rod(c.strand).Jacobians(oracle::ToFrame(c.clamp), oracle::Stack(c.theta), rule);
      for (int Q = 0; Q < N; ++Q) {
        for (int g = 0; g < 3; ++g) {
          const double u = static_cast<double>(rule.nodes[g]);
          const MatrixXd mine = PointAt(c.strand, c.clamp, c.theta, {Q, u}).J;
          ASSERT_EQ(mine.cols(), 3 * N);
          // Differences err by about 3e-14 of a derivative of order L.
          EXPECT_LT((mine - J[3 * Q + g].cast<double>()).norm(), 2e-13 * N);
          EXPECT_TRUE(mine.rightCols(3 * (N - 1 - Q)).isZero(0));
        }
      }
    }
  }
}

TEST(ChainTest, ElementsMeetWithoutAKink) {
  const Case c = MakeCase(6, 3, 77);
  const auto at = [&](int Q, double u) { return PointAt(c.strand, c.clamp, c.theta, {Q, u}).r; };
  for (int Q = 0; Q + 1 < 6; ++Q) {
    EXPECT_LT((at(Q, 1) - at(Q + 1, 0)).norm(), 1e-15);
    // One-sided second order differences of both sides: error (angle e)^2 = 3e-7, rounding 1e-12.
    const double e = 1e-4;
    const Vector3d left =
        (3 * at(Q, 1) - 4 * at(Q, 1 - e) + at(Q, 1 - 2 * e)) / (2 * e * c.strand.length[Q]);
    const Vector3d right = (-3 * at(Q + 1, 0) + 4 * at(Q + 1, e) - at(Q + 1, 2 * e)) /
                           (2 * e * c.strand.length[Q + 1]);
    EXPECT_LT((left - right).norm(), 1e-6);
    EXPECT_LT((ElementFrames(c.strand, c.clamp, c.theta)[Q + 1].R.col(0) - left).norm(), 1e-6);
  }
}

TEST(ChainTest, PolylinesAreAtMostAsLongAsTheStrandAndTendToIt) {
  for (const int N : {1, 5}) {
    const Case c = MakeCase(N, 10, 5 + N);
    const double L = c.strand.TotalLength();
    double deficit[2];
    for (int level = 0; level < 2; ++level) {
      const int points = 1000 << level;
      double length = 0;
      Vector3d previous = c.clamp.p;
      for (int i = 1; i <= points; ++i) {
        const Vector3d r = PointAt(c.strand, c.clamp, c.theta, Locate(c.strand, L * i / points)).r;
        EXPECT_LE((r - previous).norm(), L / points * (1 + 1e-10));
        length += (r - previous).norm();
        previous = r;
      }
      EXPECT_LE(length, L * (1 + 1e-12));
      deficit[level] = L - length;
    }
    // A chord is short by (kappa ds)^2 / 24 of itself: a quarter at half the spacing.
    EXPECT_GT(deficit[0], 0);
    EXPECT_NEAR(deficit[0] / deficit[1], 4, 0.01);
    EXPECT_LT(deficit[1], 1e-4 * L);
  }
}

TEST(ChainTest, MassMatrixAgreesWithBruteForce) {
  for (const int N : {1, 2, 4}) {
    for (const double angle : {0.0, 1e-8, 1.0, 6.0, 20.0}) {
      const Case c = MakeCase(N, angle, 20 + N);
      const MatrixXd M = MassMatrix(c.strand, c.clamp, c.theta, 48);
      const MatrixXd brute = oracle::Rod(c.strand)
                                 .Mass(oracle::ToFrame(c.clamp), oracle::Stack(c.theta))
                                 .cast<double>();
      EXPECT_LT((M - brute).norm(), 1e-12 * brute.norm()) << "N=" << N << " angle=" << angle;
      const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(M);
      EXPECT_GT(modes.eigenvalues()[0], -1e-15 * M.norm());
      const MatrixXd elsewhere = MassMatrix(c.strand, fixtures::Random(3).Pose(), c.theta, 48);
      EXPECT_LT((M - elsewhere).norm(), 1e-13 * M.norm());
    }
  }
}

TEST(ChainTest, TheStepsGaussPointsSufficeForGentleElements) {
  // The integrand has the bandwidth 2 |theta|, and 3 points integrate degree 5 exactly, which
  // leaves the square of the angle and more.
  double error[2];
  for (int i = 0; i < 2; ++i) {
    Case c = MakeCase(2, 1, 4);
    for (Vector3d& theta : c.theta) theta = theta.normalized() * (i == 0 ? 1.0 : 2.0);
    const MatrixXd fine = MassMatrix(c.strand, c.clamp, c.theta, 48);
    error[i] = (MassMatrix(c.strand, c.clamp, c.theta, kGaussPoints) - fine).norm() / fine.norm();
  }
  EXPECT_LT(error[0], 3e-5);
  EXPECT_LT(error[1], 3e-4);
  EXPECT_GT(std::log2(error[1] / error[0]), 2);
}

TEST(ChainTest, LocateInvertsTheSumOfLengths) {
  const Case c = MakeCase(7, 1, 8);
  const double L = c.strand.TotalLength();
  for (double s = -0.1 * L; s < 1.1 * L; s += 0.0137 * L) {
    const ArcPosition where = Locate(c.strand, s);
    ASSERT_GE(where.element, 0);
    ASSERT_LT(where.element, 7);
    EXPECT_GE(where.fraction, 0);
    EXPECT_LE(where.fraction, 1);
    double arc = where.fraction * c.strand.length[where.element];
    for (int Q = 0; Q < where.element; ++Q) arc += c.strand.length[Q];
    EXPECT_NEAR(arc, std::clamp(s, 0.0, L), 1e-15);
  }
  EXPECT_EQ(Locate(c.strand, 0).element, 0);
  EXPECT_EQ(Locate(c.strand, L).element, 6);
}

TEST(ChainTest, RefusesTheWrongNumberOfAngles) {
  const Case c = MakeCase(3, 1, 9);
  const std::vector<Vector3d> two(2);
  EXPECT_THROW((void)ElementFrames(c.strand, c.clamp, two), base::CheckFailure);
}

}  // namespace
}  // namespace mane::rod
