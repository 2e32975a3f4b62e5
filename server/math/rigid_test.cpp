// Properties of rotations and poses:
//   exponential   FromRotationVector agrees with the power series of the matrix exponential
//   logarithm     RotationVector undoes it, by the shorter arc, also for -q
//   group         poses compose, invert and act as 4 x 4 matrices do
//   interpolation constant velocity from a to b, ends exact, extrapolates

#include "math/rigid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace mane::math {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

class RigidTest : public ::testing::Test {
 protected:
  Vector3d Vector() { return {normal_(rng_), normal_(rng_), normal_(rng_)}; }
  Vector3d Direction() { return Vector().normalized(); }
  Quaterniond Rotation() {
    return Quaterniond(normal_(rng_), normal_(rng_), normal_(rng_), normal_(rng_)).normalized();
  }
  Pose RandomPose() { return {Vector(), Rotation()}; }

 private:
  std::mt19937_64 rng_{611};
  std::normal_distribution<double> normal_;
};

// exp([v]) by squaring a power series: no sine, no quaternion.
Matrix3d MatrixExponential(const Vector3d& v) {
  using Matrix3 = Eigen::Matrix<long double, 3, 3>;
  Matrix3 X;
  X << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  X /= 1024;
  Matrix3 sum = Matrix3::Identity(), term = sum;
  for (int k = 1; k < 20; ++k) {
    term = term * X / k;
    sum += term;
  }
  for (int i = 0; i < 10; ++i) sum = sum * sum;
  return sum.cast<double>();
}

Matrix4d AsMatrix(const Pose& pose) {
  Matrix4d m = Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = pose.q.toRotationMatrix();
  m.topRightCorner<3, 1>() = pose.p;
  return m;
}

TEST_F(RigidTest, ExponentialAgreesWithItsPowerSeries) {
  for (const double angle :
       {0.0, 1e-300, 1e-12, 0.99e-8, 1.01e-8, 1e-4, 1.0, 3.0, kPi, 4.0, 6.28, 10.0, 50.0}) {
    for (int i = 0; i < 20; ++i) {
      const Vector3d v = angle * Direction();
      const Quaterniond q = FromRotationVector(v);
      EXPECT_NEAR(q.norm(), 1, 1e-15);
      // Squaring ten times multiplies long double rounding by 1024; sines round by angle ulp.
      EXPECT_LT((q.toRotationMatrix() - MatrixExponential(v)).norm(), 1e-15 * (4 + angle)) << angle;
    }
  }
}

TEST_F(RigidTest, SmallRotationVectorsKeepTheirDigits) {
  for (const double angle : {1e-200, 1e-14, 1e-9, 0.99e-8, 1.01e-8, 1e-5}) {
    const Vector3d v = angle * Direction();
    EXPECT_LT((FromRotationVector(v).vec() - 0.5 * v).norm(), angle * (angle * angle / 40 + 1e-15));
    EXPECT_LT((RotationVector(FromRotationVector(v)) - v).norm(), 1e-15 * angle) << angle;
  }
}

TEST_F(RigidTest, LogarithmUndoesExponential) {
  for (int i = 0; i < 1000; ++i) {
    const Vector3d v = kPi * (i / 1000.0) * Direction();
    EXPECT_LT((RotationVector(FromRotationVector(v)) - v).norm(), 1e-14) << v.norm();
  }
}

TEST_F(RigidTest, LogarithmTakesTheShorterArcWhateverTheSign) {
  for (int i = 0; i < 1000; ++i) {
    const Quaterniond q = Rotation();
    const Quaterniond negative(-q.w(), -q.x(), -q.y(), -q.z());
    const Vector3d v = RotationVector(q);
    EXPECT_LE(v.norm(), kPi * (1 + 1e-15));
    EXPECT_LT((v - RotationVector(negative)).norm(), 1e-14);
    EXPECT_LT((MatrixExponential(v) - q.toRotationMatrix()).norm(), 1e-14);
  }
}

TEST_F(RigidTest, CrossIsTheMatrixOfTheProduct) {
  const Vector3d a = Vector(), b = Vector();
  EXPECT_LT((Cross(a) * b - a.cross(b)).norm(), 1e-15);
}

TEST_F(RigidTest, PosesFormAGroupThatActsOnPoints) {
  for (int i = 0; i < 200; ++i) {
    const Pose a = RandomPose(), b = RandomPose();
    const Vector3d x = Vector();
    const double tolerance = 1e-14 * (1 + a.p.norm() + b.p.norm() + x.norm());
    EXPECT_LT((AsMatrix(a * b) - AsMatrix(a) * AsMatrix(b)).norm(), tolerance);
    EXPECT_LT((AsMatrix(a.Inverse()) - AsMatrix(a).inverse()).norm(), tolerance);
    EXPECT_LT((a * x - (AsMatrix(a) * x.homogeneous()).head<3>()).norm(), tolerance);
    EXPECT_LT((AsMatrix(a * a.Inverse()) - Matrix4d::Identity()).norm(), tolerance);
  }
}

TEST_F(RigidTest, InterpolatesAtConstantVelocityThroughBothEnds) {
  for (int i = 0; i < 200; ++i) {
    const Pose a = RandomPose(), b = RandomPose();
    EXPECT_LT((AsMatrix(Interpolate(a, b, 0)) - AsMatrix(a)).norm(), 1e-14);
    EXPECT_LT((AsMatrix(Interpolate(a, b, 1)) - AsMatrix(b)).norm(), 3e-14);
    // One world rotation per unit of u, the same everywhere, outside [0, 1] too.
    const double du = 0.25;
    const Vector3d turn = RotationVector(b.q * a.q.conjugate());
    for (double u = -0.5; u < 1.5; u += du) {
      const Pose here = Interpolate(a, b, u), next = Interpolate(a, b, u + du);
      EXPECT_LT((next.p - here.p - du * (b.p - a.p)).norm(), 1e-14);
      EXPECT_LT((RotationVector(next.q * here.q.conjugate()) - du * turn).norm(), 1e-13);
    }
  }
}

}  // namespace
}  // namespace mane::math
