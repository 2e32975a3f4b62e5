// Properties of one wound element:
//   reference    axis, frame and hair agree with an RK4 integration of A' = A [beta], r' = A t
//   exactness    a coil that is only twisted and stretched is the plain helix of its strains
//   derivatives  J, T, G and those of the axis agree with finite differences
//   hair         also where C9 is singular
//   length       the hair put around the axis is as long as its arc length, its tangent a unit one
//   stiffness    whole turns comply as a chain of plain elements does, bent, twisted and pulled
//   inertia      the beads have the coil's moments about its axis

#include "rod/coil_element.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>
#include <vector>

#include "math/rigid.h"
#include "rod/helix.h"
#include "rod/scheme.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A natural curvature with all three components, as no Appendix B hair has.
constexpr double kLength = 0.03;  // m

Coil AnyCoil() { return MakeCoil({40, 220, -90}, {1.0e-9, 1.3e-9, 1.9e-9}); }

std::vector<Vector4d> States() {
  fixtures::Random random(7);
  std::vector<Vector4d> states = {Vector4d::Zero()};
  for (int i = 0; i < 20; ++i) {
    Vector4d x;
    for (double& v : x) v = random.Uniform(-1.5, 1.5);
    states.push_back(x);
  }
  return states;
}

struct Rk4State {
  Matrix3d A = Matrix3d::Identity();
  Vector3d axis = Vector3d::Zero();
  Vector3d hair = Vector3d::Zero();
};

// Integrates to `s`; error about (7 rad / steps)^4.
Rk4State IntegrateRk4(const CoilAxis& axis, double phase, double s, int steps = 4000) {
  const double h = s / steps;
  const auto rate = [&](const Rk4State& y, double at) {
    const double phi = phase + axis.winding * at;
    const Vector3d t(axis.stretch, axis.slant * std::cos(phi), axis.slant * std::sin(phi));
    return Rk4State{y.A * math::Cross(axis.beta), y.A.col(0) * axis.stretch, y.A * t};
  };
  const auto add = [](const Rk4State& y, const Rk4State& d, double k) {
    return Rk4State{y.A + k * d.A, y.axis + k * d.axis, y.hair + k * d.hair};
  };
  Rk4State y;
  for (int i = 0; i < steps; ++i) {
    const double at = i * h;
    const Rk4State k1 = rate(y, at), k2 = rate(add(y, k1, h / 2), at + h / 2),
                   k3 = rate(add(y, k2, h / 2), at + h / 2), k4 = rate(add(y, k3, h), at + h);
    y = add(add(add(add(y, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
  }
  return y;
}

TEST(CoilElementTest, AgreesWithRk4) {
  const Coil coil = AnyCoil();
  for (const Vector4d& x : States()) {
    const CoilAxis axis = AxisOfElement(coil, kLength, x);
    for (const double s : {0.2, 1.0}) {
      const Rk4State expected = IntegrateRk4(axis, 0.4, s);
      const CoilPoint point = PointOnCoil(axis, s, Vector3d::Zero());
      EXPECT_LT((point.E - expected.A).norm(), 1e-11);
      EXPECT_LT((point.p - expected.axis).norm(), 1e-11);
      EXPECT_LT((HairOnCoil(axis, 0.4, s) - expected.hair).norm(), 1e-11);
    }
    const int points = 2000;  // Midpoint rule: error of second order.
    Vector3d mean = Vector3d::Zero();
    for (int i = 0; i < points; ++i) {
      mean += PointOnCoil(axis, (i + 0.5) / points, Vector3d::Zero()).p / points;
    }
    EXPECT_LT((EndOfCoil(axis).c - mean).norm(), 1e-6);
  }
}

TEST(CoilElementTest, HairHoldsWhereTheAxisTurnsAsFastAsTheCoil) {
  const Coil coil = AnyCoil();
  const double W = coil.winding * kLength;
  for (const double times : {0.49, 0.51, 1 - 1e-9, 1.0, 1 + 1e-6, 1.7}) {
    for (const double u : {0.0, 0.3 * W}) {
      const Vector4d x(u, times * 0.6 * W, -times * 0.8 * W, 0);
      const CoilAxis axis = AxisOfElement(coil, kLength, x);
      for (const double s : {0.0, 0.2, 1.0}) {
        const Vector3d expected = IntegrateRk4(axis, 0.4, s).hair;
        EXPECT_LT((HairOnCoil(axis, 0.4, s) - expected).norm(), 1e-10) << times;
      }
    }
  }
}

TEST(CoilElementTest, IsThePlainHelixWhereItsAxisIsStraight) {
  const Vector3d natural(40, 220, -90);
  const Coil coil = AnyCoil();
  for (Vector4d x : States()) {
    x[1] = x[2] = 0;
    const CoilAxis axis = AxisOfElement(coil, kLength, x);
    const Vector3d theta = kLength * natural + coil.F * Vector3d(x[0], x[3], 0);
    const double tilt = std::atan2(x[3], axis.winding + x[0]);
    const Matrix3d frame = coil.F * Eigen::AngleAxisd(tilt, Vector3d::UnitZ()).toRotationMatrix();
    for (const double s : {0.3, 1.0}) {
      EXPECT_LT((frame * HairOnCoil(axis, 0, s) - PointOnElement(theta, s).p).norm(), 1e-14);
    }
  }
}

TEST(CoilElementTest, DerivativesAgreeWithFiniteDifferences) {
  const Coil coil = AnyCoil();
  const double h = 1e-5, tolerance = 1e-9;
  const Vector3d offset(0.02, 0.1, -0.2);
  for (const Vector4d& x : States()) {
    const CoilAxis axis = AxisOfElement(coil, kLength, x);
    for (int i = 0; i < 4; ++i) {
      const CoilAxis low = AxisOfElement(coil, kLength, x - h * Vector4d::Unit(i));
      const CoilAxis high = AxisOfElement(coil, kLength, x + h * Vector4d::Unit(i));
      EXPECT_LT((axis.dbeta.col(i) - (high.beta - low.beta) / (2 * h)).norm(), tolerance);
      EXPECT_NEAR(axis.dstretch[i], (high.stretch - low.stretch) / (2 * h), tolerance);
      const Vector3d G = (EndOfCoil(high).c - EndOfCoil(low).c) / (2 * h);
      EXPECT_LT((EndOfCoil(axis).G.col(i) - G).norm(), tolerance);
      for (const double s : {0.3, 1.0}) {
        const CoilPoint point = PointOnCoil(axis, s, offset);
        const CoilPoint a = PointOnCoil(low, s, offset), b = PointOnCoil(high, s, offset);
        EXPECT_LT((point.J.col(i) - (b.p - a.p) / (2 * h)).norm(), tolerance);
        const Matrix3d turn = (b.E - a.E) / (2 * h) * point.E.transpose();
        EXPECT_LT((math::Cross(point.T.col(i)) - turn).norm(), tolerance);
      }
    }
  }
}

TEST(CoilElementTest, TheHairKeepsItsLength) {
  const Coil coil = AnyCoil();
  const double h = 1e-5;
  for (const Vector4d& x : States()) {
    const CoilAxis axis = AxisOfElement(coil, kLength, x);
    for (const double s : {0.1, 0.5, 0.9}) {
      const double phase = 1.1 + axis.winding * s;
      const Vector3d tangent = PointOnCoil(axis, s, Vector3d::Zero()).E * CoilTangent(axis, phase);
      EXPECT_NEAR(tangent.norm(), 1, 1e-14);
      EXPECT_LT(((HairOnCoil(axis, 1.1, s + h) - HairOnCoil(axis, 1.1, s - h)) / (2 * h) - tangent)
                    .norm(),
                1e-8);
    }
  }
}

// Compliance of `turns` whole turns of plain elements to a force and a moment at the axis's end,
// in the coil's axes, by the linear theory of a chain: sum of S K^-1 S^T.
Eigen::Matrix<double, 6, 6> PlainCompliance(const Vector3d& natural, const Vector3d& stiffness,
                                            const Coil& coil, int turns, int elements) {
  const double length = turns * 2 * M_PI / coil.winding, l = length / elements;
  const Vector3d theta = l * natural;
  const ElementEnd end = EndOfElement(theta);
  std::vector<Matrix3d> R = {Matrix3d::Identity()};
  std::vector<Vector3d> r = {Vector3d::Zero()};
  for (int Q = 0; Q < elements; ++Q) {
    r.emplace_back(r.back() + l * R.back() * end.p);
    R.emplace_back(R.back() * end.E);
  }
  const Vector3d tip = coil.F * Vector3d(length * coil.rise, 0, coil.radius);
  Eigen::Matrix<double, 6, 6> compliance = Eigen::Matrix<double, 6, 6>::Zero();
  for (int Q = 0; Q < elements; ++Q) {
    Eigen::Matrix<double, 6, 3> S;
    S.bottomRows<3>() = coil.F.transpose() * R[Q] * end.T;
    S.topRows<3>() =
        coil.F.transpose() * (l * R[Q] * end.J - math::Cross(tip - r[Q + 1]) * R[Q] * end.T);
    compliance += S * (l * stiffness.cwiseInverse()).asDiagonal() * S.transpose();
  }
  return compliance;
}

TEST(CoilElementTest, WholeTurnsComplyAsPlainElementsDo) {
  const Vector3d natural(40, 220, -90), stiffness(1.0e-9, 1.3e-9, 1.9e-9);
  const Coil coil = MakeCoil(natural, stiffness);
  const int turns = 3;
  const double length = turns * 2 * M_PI / coil.winding;
  const CoilAxis axis = AxisOfElement(coil, length, Vector4d::Zero());
  const CoilPoint end = PointOnCoil(axis, 1, Vector3d::Zero());
  Eigen::Matrix<double, 6, 4> S;
  S << length * end.J, end.T;
  const Eigen::Matrix4d K = coil.stiffness / length;
  const Eigen::Matrix<double, 6, 6> wound = S * K.inverse() * S.transpose();
  const Eigen::Matrix<double, 6, 6> plain = PlainCompliance(natural, stiffness, coil, turns, 3000);
  // Pull along the axis, twist about it, and both together.
  for (const int i : {0, 3}) {
    for (const int k : {0, 3}) EXPECT_NEAR(wound(i, k) / plain(i, k), 1, 1e-5);
  }
  // Bends about either axis across; none couples with the twist.
  const Matrix3d turn = plain.bottomRightCorner<3, 3>();
  EXPECT_LT((wound.bottomRightCorner<3, 3>() - turn).norm(), 1e-5 * turn.norm());
  // How a bend moves the end: one turn's phase is not resolved.
  const Matrix3d bend = plain.topRightCorner<3, 3>();
  EXPECT_LT((wound.topRightCorner<3, 3>() - bend).norm(), 0.5 * bend.norm());
}

TEST(CoilElementTest, BeadsHaveTheMomentsOfTheCoil) {
  const Coil coil = AnyCoil();
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (int g = 0; g < kBeads; ++g) {
    const Vector3d o = BeadOffset(coil, g);
    first += kBeadRule.weights[g] * o;
    second += kBeadRule.weights[g] * o * o.transpose();
  }
  const double half = coil.radius * coil.radius / 2;
  EXPECT_LT(first.norm(), 1e-15 * coil.radius);
  EXPECT_LT((second - Vector3d(0, half, half).asDiagonal().toDenseMatrix()).norm(), 1e-14 * half);
}

}  // namespace
}  // namespace mane::rod
