// Properties of one element in closed form, at angles from zero to several turns:
//   oracle        (7a), (7b) of [SH06] agree with an RK4 integration of (1a), (1b)
//   reference     point, frame and centre of mass agree with that oracle
//   derivatives   J, T and G agree with finite differences of the oracle
//   group law     advancing by s then t equals advancing by s + t; frames stay orthonormal
//   limit         a straight element is exactly straight

#include "rod/helix.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "rod/test_oracle.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using oracle::Frame;
using oracle::Matrix3;
using oracle::Real;
using oracle::Vector3;

// Sines of an angle round by angle ulp; everything else by a few ulp of the unit length.
double Tolerance(double angle) { return 2e-15 * (1 + angle); }

// Every angle with several axes, among them the frame's own: pure twist and pure bends.
class HelixTest : public ::testing::TestWithParam<double> {
 protected:
  std::vector<Vector3d> Thetas() {
    fixtures::Random random(31);
    std::vector<Vector3d> thetas = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
    for (int i = 0; i < 12; ++i) thetas.push_back(random.Direction());
    for (Vector3d& theta : thetas) theta *= GetParam();
    return thetas;
  }
};

INSTANTIATE_TEST_SUITE_P(Angles, HelixTest,
                         ::testing::Values(0.0, 1e-150, 1e-8, 1e-3, 1.0, 1.999999, 2.000001, 6.0,
                                           20.0, 50.0));

// The oracle's element from the identity frame.
Frame Element(const Vector3& theta, Real s) { return oracle::Advance(Frame{}, theta, s); }

// Fourth order differences of f by each component of theta: error 3e-14, as of the oracle.
template <typename F>
Matrix3d Derivative(const Vector3d& theta, const F& f) {
  const Real h = 1e-3L;
  Matrix3 d;
  for (int i = 0; i < 3; ++i) {
    const auto at = [&](int k) -> Vector3 {
      Vector3 moved = theta.cast<Real>();
      moved[i] += k * h;
      return f(moved);
    };
    d.col(i) = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h);
  }
  return d.cast<double>();
}

constexpr double kDifferenceError = 2e-13;

TEST_P(HelixTest, OracleAgreesWithRk4) {
  for (const Vector3d& theta : Thetas()) {
    const int steps = 4000;
    const Frame exact = Element(theta.cast<Real>(), 1);
    const Frame rk4 = oracle::IntegrateRk4(Frame{}, theta.cast<Real>(), 1, steps);
    const double angle = GetParam();
    const double tolerance = angle * std::pow(angle / steps, 4) / 100 + 1e-16;
    EXPECT_LT(static_cast<double>((exact.n - rk4.n).norm()), 2 * tolerance);
    EXPECT_LT(static_cast<double>((exact.r - rk4.r).norm()), 2 * tolerance);
  }
}

TEST_P(HelixTest, PointAndFrameAgreeWithTheOracle) {
  for (const Vector3d& theta : Thetas()) {
    for (const double s : {0.0, 1e-9, 0.1, 0.5, 0.93, 1.0}) {
      const Vector3d p = Element(theta.cast<Real>(), s).r.cast<double>();
      EXPECT_LT((PointOnElement(theta, s).p - p).norm(), Tolerance(GetParam()) * s + 1e-300);
    }
    const Frame end = Element(theta.cast<Real>(), 1);
    EXPECT_LT((EndOfElement(theta).p - end.r.cast<double>()).norm(), Tolerance(GetParam()));
    EXPECT_LT((EndOfElement(theta).E - end.n.cast<double>()).norm(), Tolerance(GetParam()) * 2);
  }
}

TEST_P(HelixTest, CentreOfMassIsTheMeanPoint) {
  const oracle::Rule& rule = oracle::GaussRule(96);  // Resolves 50 rad to round-off.
  for (const Vector3d& theta : Thetas()) {
    Vector3 mean = Vector3::Zero();
    for (size_t g = 0; g < rule.nodes.size(); ++g) {
      mean += rule.weights[g] * Element(theta.cast<Real>(), rule.nodes[g]).r;
    }
    EXPECT_LT((EndOfElement(theta).c - mean.cast<double>()).norm(), Tolerance(GetParam()));
  }
}

TEST_P(HelixTest, JacobiansAgreeWithFiniteDifferences) {
  const double tolerance = kDifferenceError + Tolerance(GetParam());
  for (const Vector3d& theta : Thetas()) {
    for (const double s : {0.0, 0.07, 0.5, 1.0}) {
      const Matrix3d J = Derivative(theta, [&](const Vector3& x) { return Element(x, s).r; });
      EXPECT_LT((PointOnElement(theta, s).J - J).norm(), tolerance) << s;
    }
    const ElementEnd end = EndOfElement(theta);
    EXPECT_LT((end.J - PointOnElement(theta, 1).J).norm(), Tolerance(GetParam()));

    const oracle::Rule& rule = oracle::GaussRule(96);
    const Matrix3d G = Derivative(theta, [&](const Vector3& x) {
      Vector3 mean = Vector3::Zero();
      for (size_t g = 0; g < rule.nodes.size(); ++g) {
        mean += rule.weights[g] * Element(x, rule.nodes[g]).r;
      }
      return mean;
    });
    EXPECT_LT((end.G - G).norm(), tolerance);
  }
}

TEST_P(HelixTest, RotationRateAgreesWithFiniteDifferences) {
  for (const Vector3d& theta : Thetas()) {
    const Matrix3 E = Element(theta.cast<Real>(), 1).n;
    // The rotation vector of E(theta + d) E^T to first order is the skew part.
    const Matrix3d T = Derivative(theta, [&](const Vector3& x) {
      const Matrix3 turn = Element(x, 1).n * E.transpose();
      return Vector3((turn(2, 1) - turn(1, 2)) / 2, (turn(0, 2) - turn(2, 0)) / 2,
                     (turn(1, 0) - turn(0, 1)) / 2);
    });
    EXPECT_LT((EndOfElement(theta).T - T).norm(), kDifferenceError + Tolerance(GetParam()));
  }
}

TEST_P(HelixTest, ComposesAlongTheElement) {
  for (const Vector3d& theta : Thetas()) {
    const double s = 0.37;
    const ElementEnd first = EndOfElement(s * theta), second = EndOfElement((1 - s) * theta),
                     both = EndOfElement(theta);
    const double tolerance = 4 * Tolerance(GetParam());
    EXPECT_LT((first.E * second.E - both.E).norm(), tolerance);
    EXPECT_LT((s * first.p + (1 - s) * first.E * second.p - both.p).norm(), tolerance);
    EXPECT_LT((s * first.p - PointOnElement(theta, s).p).norm(), tolerance);
    EXPECT_LT((both.E.transpose() * both.E - Matrix3d::Identity()).norm(), tolerance);
    EXPECT_NEAR(both.E.determinant(), 1, tolerance);
    // The axis of the helix is left where it is.
    EXPECT_LT((both.E * theta - theta).norm(), tolerance * (GetParam() + 1e-300));
  }
}

TEST(StraightHelixTest, IsExactlyStraight) {
  EXPECT_EQ(PointOnElement(Vector3d::Zero(), 0.7).p, Vector3d(0.7, 0, 0));
  EXPECT_EQ(PointOnElement({12, 0, 0}, 1).p, Vector3d(1, 0, 0));  // Twist alone bends nothing.
  EXPECT_EQ(EndOfElement(Vector3d::Zero()).E, Matrix3d::Identity());
  EXPECT_EQ(EndOfElement(Vector3d::Zero()).T, Matrix3d::Identity());
  EXPECT_EQ(EndOfElement(Vector3d::Zero()).c, Vector3d(0.5, 0, 0));
}

}  // namespace
}  // namespace mane::rod
