// Properties of the sampled Super-Helix:
//   reference    agrees with a fine RK4 integration of the frame equations, which shares no code
//   closed form  a plane element is an arc; a full turn closes; a twisted bend is a helix of the
//                known radius and pitch
//   limit        zero angles are a straight strand; small angles meet them smoothly
//   arc length   points are equally spaced along the strand whatever its elements are
//   frames       moving the root moves every point rigidly

#include "wire/reconstruct.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

namespace mane::wire {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Strand {
  math::Pose root;
  std::vector<double> lengths;
  std::vector<Vector3d> theta;

  double TotalLength() const { return std::accumulate(lengths.begin(), lengths.end(), 0.0); }
};

std::vector<Vector3d> Sampled(const Strand& s, size_t points) {
  std::vector<Vector3d> out(points);
  SamplePoints(s.root, s.lengths, s.theta, std::span(out));
  return out;
}

struct State {
  Matrix3d R;
  Vector3d r;
};

State Derivative(const State& x, const Vector3d& kappa) {
  Matrix3d dR;
  for (int row = 0; row < 3; ++row) {
    dR.row(row) = x.R.row(row).transpose().cross(kappa).transpose();
  }
  return {dR, x.R.col(0)};
}

State Plus(const State& x, const State& d, double h) { return {x.R + h * d.R, x.r + h * d.r}; }

// Integrates R' = R [kappa], r' = n0 over arc length `s`.
State Rk4(State x, const Vector3d& kappa, double s, int steps) {
  const double h = s / steps;
  for (int i = 0; i < steps; ++i) {
    const State k1 = Derivative(x, kappa), k2 = Derivative(Plus(x, k1, h / 2), kappa),
                k3 = Derivative(Plus(x, k2, h / 2), kappa), k4 = Derivative(Plus(x, k3, h), kappa);
    x = Plus(Plus(Plus(Plus(x, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
  }
  return x;
}

// The point at arc length `s` by integration through the elements.
Vector3d Integrated(const Strand& strand, double s) {
  State x{strand.root.q.toRotationMatrix(), strand.root.p};
  for (size_t q = 0; q < strand.lengths.size() && s > 0; ++q) {
    const double l = strand.lengths[q];
    x = Rk4(x, strand.theta[q] / l, std::min(s, l), 400);
    s -= l;
  }
  return x.r;
}

class ReconstructTest : public ::testing::Test {
 protected:
  double Symmetric() { return unit_(rng_); }
  Vector3d RandomVector() { return {Symmetric(), Symmetric(), Symmetric()}; }

  // `n` elements between 1 and 5 cm, each bent by up to about 3 rad.
  Strand RandomStrand(int n) {
    Strand s;
    s.root.p = RandomVector();
    s.root.q = math::FromRotationVector(3 * RandomVector());
    for (int q = 0; q < n; ++q) {
      s.lengths.push_back(0.03 + 0.02 * Symmetric());
      s.theta.push_back(2 * RandomVector());
    }
    return s;
  }

 private:
  std::mt19937_64 rng_{20060730};
  std::uniform_real_distribution<double> unit_{-1, 1};
};

TEST_F(ReconstructTest, AgreesWithAnIndependentIntegratorForAnyNumberOfUnequalElements) {
  for (const int n : {1, 2, 3, 5, 17, 64}) {
    SCOPED_TRACE(n);
    const Strand strand = RandomStrand(n);
    const auto points = Sampled(strand, 11);
    for (size_t i = 0; i < points.size(); ++i) {
      const double s = strand.TotalLength() * static_cast<double>(i) / 10;
      // RK4's error per element is about l theta (theta / 400)^4 / 120 < 1e-12 m.
      EXPECT_LT((points[i] - Integrated(strand, s)).norm(), 1e-10) << "point " << i;
    }
  }
}

TEST_F(ReconstructTest, OneBentElementIsACircularArcAndAFullTurnCloses) {
  const double length = 0.2, angle = 2 * std::numbers::pi;
  const Strand strand{{}, {length}, {Vector3d(0, 0, angle)}};  // Bends about n2 = +Z.
  const auto points = Sampled(strand, 9);
  const double radius = length / angle;
  for (size_t i = 0; i < points.size(); ++i) {
    const double turned = angle * static_cast<double>(i) / 8;
    const Vector3d arc(radius * std::sin(turned), radius * (1 - std::cos(turned)), 0);
    EXPECT_LT((points[i] - arc).norm(), 1e-15) << "point " << i;
  }
}

TEST_F(ReconstructTest, ATwistedBendIsAHelixOfKnownRadiusAndPitch) {
  const double tau = 30, kappa = 40, total = 50;  // |(tau, kappa)| [rad/m]
  const double length = 2 * std::numbers::pi / total;
  const Strand strand{{}, {length}, {length * Vector3d(tau, 0, kappa)}};
  const auto points = Sampled(strand, 3);
  const Vector3d axis = Vector3d(tau, 0, kappa) / total;
  const Vector3d turn = points[2] - points[0];  // One whole turn goes along the axis only.
  EXPECT_LT((turn - length * tau / total * axis).norm(), 1e-15);
  const Vector3d half = points[1] - points[0];  // Half a turn is a diameter off it.
  EXPECT_NEAR((half - half.dot(axis) * axis).norm(), 2 * kappa / (total * total), 1e-15);
}

TEST_F(ReconstructTest, ZeroAnglesAreAStraightStrandAlongN0) {
  Strand strand = RandomStrand(5);
  for (Vector3d& theta : strand.theta) theta.setZero();
  const auto points = Sampled(strand, 16);
  const Vector3d n0 = strand.root.q * Vector3d::UnitX();
  for (size_t i = 0; i < points.size(); ++i) {
    const double s = strand.TotalLength() * static_cast<double>(i) / 15;
    EXPECT_LT((points[i] - (strand.root.p + s * n0)).norm(), 1e-15) << "point " << i;
  }
}

TEST_F(ReconstructTest, SmallAnglesBendByHalfTheAngle) {
  for (const double angle : {1e-3, 1e-6, 1e-9}) {
    SCOPED_TRACE(angle);
    const Strand strand{{}, {1.0}, {Vector3d(0, 0, angle)}};
    const auto points = Sampled(strand, 2);
    EXPECT_NEAR(points[1].y(), angle / 2, angle * angle * angle + 1e-16);
    EXPECT_NEAR(points[1].x(), 1, angle * angle + 1e-15);
  }
}

TEST_F(ReconstructTest, SplittingElementsChangesNothing) {
  const Strand whole = RandomStrand(4);
  Strand split{whole.root, {}, {}};
  for (size_t q = 0; q < 4; ++q) {
    for (const double part : {0.125, 0.6, 0.275}) {
      split.lengths.push_back(part * whole.lengths[q]);
      split.theta.push_back(part * whole.theta[q]);
    }
  }
  const auto expected = Sampled(whole, 33), actual = Sampled(split, 33);
  for (size_t i = 0; i < 33; ++i) EXPECT_LT((expected[i] - actual[i]).norm(), 1e-14) << i;
}

TEST_F(ReconstructTest, NeighboursAreNoFartherApartThanTheirArcLength) {
  for (int trial = 0; trial < 50; ++trial) {
    const Strand strand = RandomStrand(1 + trial % 9);
    const size_t count = 2 + static_cast<size_t>(trial) * 5;
    const auto points = Sampled(strand, count);
    const double spacing = strand.TotalLength() / static_cast<double>(count - 1);
    EXPECT_LT((points[0] - strand.root.p).norm(), 1e-16);
    for (size_t i = 1; i < count; ++i) {
      EXPECT_LT((points[i] - points[i - 1]).norm(), spacing * (1 + 1e-9) + 1e-15);
    }
  }
}

TEST_F(ReconstructTest, MovingTheRootMovesEveryPointRigidly) {
  const Strand strand = RandomStrand(6);
  const math::Pose head{RandomVector(), math::FromRotationVector(RandomVector())};
  Strand moved = strand;
  moved.root = head * strand.root;
  const auto local = Sampled(strand, 20), world = Sampled(moved, 20);
  for (size_t i = 0; i < 20; ++i) EXPECT_LT((world[i] - head * local[i]).norm(), 1e-14) << i;
}

TEST_F(ReconstructTest, SinglePrecisionIsTheDoubleResultRounded) {
  const Strand strand = RandomStrand(5);
  const auto expected = Sampled(strand, 16);
  std::vector<Eigen::Vector3f> rounded(16);
  SamplePoints(strand.root, strand.lengths, strand.theta, std::span(rounded));
  for (size_t i = 0; i < 16; ++i) EXPECT_EQ(rounded[i], expected[i].cast<float>()) << i;
}

}  // namespace
}  // namespace mane::wire
