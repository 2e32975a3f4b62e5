#include "rod/fit_guess.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <array>
#include <cmath>

#include "rod/helix.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kSamples = 8;  // Of each element.

// Points of a piece of curve, in its left frame and in units of its length.
using Samples = std::array<Vector3d, kSamples>;

double Cost(const Samples& samples, double twist_weight, const Vector3d& theta) {
  double cost = twist_weight * theta.x() * theta.x();
  for (int i = 0; i < kSamples; ++i) {
    const ElementPoint point = PointOnElement(theta, (i + 1.0) / kSamples);
    cost += (point.p - samples[i]).squaredNorm();
  }
  return cost;
}

// Least squares of one element, by Levenberg and Marquardt.
double Refine(const Samples& samples, double twist_weight, Vector3d* theta) {
  double cost = Cost(samples, twist_weight, *theta), lambda = 1e-3;
  for (int iteration = 0; iteration < 15; ++iteration) {
    Matrix3d H = Matrix3d::Zero();
    Vector3d g(twist_weight * theta->x(), 0, 0);
    H(0, 0) = twist_weight;
    for (int i = 0; i < kSamples; ++i) {
      const ElementPoint point = PointOnElement(*theta, (i + 1.0) / kSamples);
      H += point.J.transpose() * point.J;
      g += point.J.transpose() * (point.p - samples[i]);
    }
    Matrix3d damped = H;
    damped.diagonal() += lambda * (H.diagonal() + Vector3d::Constant(1e-6));
    const Vector3d step = damped.ldlt().solve(g);
    const Vector3d trial = *theta - step;
    const double trial_cost = trial.allFinite() ? Cost(samples, twist_weight, trial) : cost;
    if (trial_cost < cost) {
      const bool done = cost - trial_cost < 1e-6 * cost;
      *theta = trial;
      cost = trial_cost;
      lambda *= 0.1;
      if (done) break;
    } else {
      lambda *= 10;
      if (lambda > 1e6) break;
    }
  }
  return cost;
}

Vector3d RotationBetween(const Vector3d& a, const Vector3d& b) {
  const Eigen::AngleAxisd turn(Quaterniond::FromTwoVectors(a, b));
  return turn.angle() * turn.axis();
}

}  // namespace

Matrix3d FrameAlong(const Vector3d& tangent) {
  int least;
  (void)tangent.cwiseAbs().minCoeff(&least);
  Matrix3d R;
  R.col(0) = tangent;
  R.col(1) = tangent.cross(Vector3d::Unit(least)).normalized();
  R.col(2) = tangent.cross(R.col(1));
  return R;
}

Matrix3d AlignedTo(const Matrix3d& R, const Vector3d& tangent) {
  return Quaterniond::FromTwoVectors(R.col(0), tangent) * R;
}

std::vector<Vector3d> GuessAngles(const SmoothCurve& curve, Matrix3d R,
                                  std::span<const double> fraction, double twist_weight) {
  const size_t N = fraction.size() - 1;
  const double L = curve.length();
  std::vector<Vector3d> theta(N);
  for (size_t Q = 0; Q < N; ++Q) {
    const double begin = fraction[Q] * L, l = (fraction[Q + 1] - fraction[Q]) * L;
    const Vector3d origin = curve.At(begin);
    Samples samples;
    for (int i = 0; i < kSamples; ++i) {
      samples[i] = R.transpose() * (curve.At(begin + l * (i + 1.0) / kSamples) - origin) / l;
    }
    // Two starts: an arc of the plane of both end tangents; and a helix that turns as the curve
    // does in its two halves, twisted by as much as the axes of these turns differ.
    const Vector3d t0 = R.col(0), t1 = curve.Tangent(begin + 0.5 * l),
                   t2 = curve.Tangent(begin + l);
    Vector3d arc = R.transpose() * RotationBetween(t0, t2);
    const Vector3d b0 = RotationBetween(t0, t1), b1 = RotationBetween(t1, t2);
    const double half = std::atan2(b0.cross(b1).dot(t1), b0.dot(b1));  // From quarter to quarter.
    const Vector3d left = Eigen::AngleAxisd(-0.5 * half, t0) * b0;
    Vector3d helix = R.transpose() * left;
    const double across = std::hypot(helix.y(), helix.z());
    helix *= across > 0 ? (b0.norm() + b1.norm()) / across : 0.0;
    helix.x() = 2 * half;
    const double arc_cost = Refine(samples, twist_weight, &arc),
                 helix_cost = Refine(samples, twist_weight, &helix);
    theta[Q] = helix_cost < arc_cost ? helix : arc;
    R = AlignedTo(R * EndOfElement(theta[Q]).E, t2);
  }
  return theta;
}

}  // namespace mane::rod
