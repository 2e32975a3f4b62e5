#include "rod/second_derivative.h"

#include <Eigen/Geometry>

#include "math/stumpff.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// f of (H3), 2 df/dz and 4 d^2f/dz^2.
struct Coefficient {
  double f, g, k;
};

// Second derivative by theta of w.(f2 theta x a + f3 theta x (theta x a)), the curves of an element
// and its rotation (Q2).
Matrix3d OfCurve(const Vector3d& theta, const Vector3d& w, const Vector3d& a, const Coefficient& f2,
                 const Coefficient& f3) {
  const Vector3d dA = a.cross(w);  // Derivatives of w.A and of w.B.
  const Vector3d dB = theta.dot(a) * w + theta.dot(w) * a - 2 * a.dot(w) * theta;
  const double wA = theta.dot(dA),
               wB = theta.dot(a) * theta.dot(w) - a.dot(w) * theta.squaredNorm();
  const Vector3d slope = f2.g * dA + f3.g * dB + (0.5 * (f2.k * wA + f3.k * wB)) * theta;
  const Matrix3d half = f3.f * w * a.transpose() + slope * theta.transpose();
  Matrix3d H = half + half.transpose();
  H.diagonal().array() += f2.g * wA + f3.g * wB - 2 * f3.f * a.dot(w);
  return H;
}

}  // namespace

Matrix3d SecondDerivative(const Vector3d& theta, const Vector3d& w, double u, double v,
                          const Vector3d& a) {
  const double zeta = theta.squaredNorm();
  const math::Stumpff C = math::StumpffC(zeta);
  const math::StumpffTail tail = math::StumpffCTail(C, zeta);
  const auto coefficient = [&](int n) {
    return Coefficient{C[n], math::TwiceDerivative(C, n),
                       math::FourTimesSecondDerivative(C, tail, n)};
  };
  const Coefficient c1 = coefficient(1), c2 = coefficient(2), c3 = coefficient(3),
                    c4 = coefficient(4);
  const auto sum = [&](const Coefficient& p, const Coefficient& c) {
    return Coefficient{u * p.f + v * c.f, u * p.g + v * c.g, u * p.k + v * c.k};
  };
  return OfCurve(theta, w, Vector3d::UnitX(), sum(c2, c3), sum(c3, c4)) +
         OfCurve(theta, w, a, c1, c2);
}

}  // namespace mane::rod
