#include "rod/helix.h"

#include "math/rigid.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::Cross;
using math::Stumpff;
using math::TwiceDerivative;

// What every curve f1 d0 + f2 A + f3 B of an element is made of: d0 = (1, 0, 0), A = theta x d0,
// B = theta x A.
struct Basis {
  Vector3d th;
  Vector3d A;
  Vector3d B;

  explicit Basis(const Vector3d& theta)
      : th(theta), A(0, theta.z(), -theta.y()), B(theta.cross(A)) {}

  // f1 d0 + f2 A + f3 B, (H3).
  [[nodiscard]] Vector3d Curve(double f1, double f2, double f3) const {
    Vector3d v = f2 * A + f3 * B;
    v.x() += f1;
    return v;
  }

  // Its derivative by theta, where g_k = 2 df_k / d|theta|^2, (H6).
  [[nodiscard]] Matrix3d Derivative(double f2, double f3, double g2, double g3) const {
    Matrix3d J = (g2 * A + g3 * B) * th.transpose();
    J.row(0) -= 2 * f3 * th.transpose();  // -2 f3 d0 theta^T
    J.col(0) += f3 * th;                  //  f3 theta d0^T
    J.diagonal().array() += f3 * th.x();  //  f3 tau I
    J(1, 2) += f2;                        // -f2 [d0]
    J(2, 1) -= f2;
    return J;
  }
};

}  // namespace

ElementPoint PointOnElement(const Vector3d& theta, double s) {
  const double s2 = s * s, s3 = s2 * s;
  const Stumpff C = math::StumpffC(s2 * theta.squaredNorm());
  const double f2 = s2 * C[2], f3 = s3 * C[3];
  const double g2 = s2 * s2 * TwiceDerivative(C, 2), g3 = s3 * s2 * TwiceDerivative(C, 3);
  const Basis basis(theta);
  return {basis.Curve(s, f2, f3), basis.Derivative(f2, f3, g2, g3)};
}

ElementEnd EndOfElement(const Vector3d& theta) {
  return EndOfElement(theta, math::StumpffC(theta.squaredNorm()));
}

ElementEnd EndOfElement(const Vector3d& theta, const Stumpff& C) {
  const Basis basis(theta);
  const Matrix3d th = Cross(theta), th2 = th * th;
  ElementEnd end;
  end.E = Matrix3d::Identity() + C[1] * th + C[2] * th2;
  end.T = Matrix3d::Identity() + C[2] * th + C[3] * th2;
  end.p = basis.Curve(1, C[2], C[3]);
  end.J = basis.Derivative(C[2], C[3], TwiceDerivative(C, 2), TwiceDerivative(C, 3));
  end.c = basis.Curve(0.5, C[3], C[4]);
  end.G = basis.Derivative(C[3], C[4], TwiceDerivative(C, 3), TwiceDerivative(C, 4));
  return end;
}

}  // namespace mane::rod
