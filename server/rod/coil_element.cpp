#include "rod/coil_element.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>
#include <complex>

#include "base/check.h"
#include "math/rigid.h"
#include "math/stumpff.h"
#include "rod/helix.h"
#include "rod/scheme.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Columns of a derivative by beta and one by lambda, by x.
Matrix34d Chain(const Matrix3d& by_beta, const Vector3d& by_stretch, const CoilAxis& axis) {
  return by_beta * axis.dbeta + by_stretch * axis.dstretch.transpose();
}

}  // namespace

Coil MakeCoil(const Vector3d& natural, const Vector3d& stiffness) {
  const double bend = natural.tail<2>().norm();
  MANE_CHECK(bend > 0);
  Coil coil;
  coil.winding = natural.norm();
  coil.rise = natural.x() / coil.winding;
  coil.slant = bend / coil.winding;
  coil.radius = coil.slant / coil.winding;
  const Vector3d axis = natural / coil.winding;
  coil.F.col(0) = axis;
  coil.F.col(1) = (Vector3d::UnitX() - coil.rise * axis) / coil.slant;
  coil.F.col(2) = axis.cross(coil.F.col(1));

  const Matrix3d compliance = coil.F.transpose() * stiffness.cwiseInverse().asDiagonal() * coil.F;
  const Eigen::Matrix2d wrench = compliance.topLeftCorner<2, 2>().inverse();
  coil.stiffness(0, 0) = wrench(0, 0);
  coil.stiffness(3, 3) = wrench(1, 1);
  coil.stiffness(0, 3) = coil.stiffness(3, 0) = wrench(0, 1);
  coil.stiffness(1, 1) = coil.stiffness(2, 2) = 2 / (compliance(1, 1) + compliance(2, 2));
  return coil;
}

CoilAxis AxisOfElement(const Coil& coil, double length, const Vector4d& x) {
  const double W = coil.winding * length, along = W + x[0], across = x[3];
  const double turn = std::hypot(along, across);
  CoilAxis axis;
  // turn - W, without its cancellation where a coil winds often.
  axis.beta = {(x[0] * (2 * W + x[0]) + across * across) / (turn + W), x[1], x[2]};
  axis.stretch = (coil.rise * along + coil.slant * across) / turn;
  axis.slant = (coil.slant * along - coil.rise * across) / turn;
  axis.dbeta.setZero();
  axis.dbeta(0, 0) = along / turn;
  axis.dbeta(0, 3) = across / turn;
  axis.dbeta(1, 1) = axis.dbeta(2, 2) = 1;
  const double rate = axis.slant / turn;  // dlambda by the angle of (along, across), over `turn`.
  axis.dstretch = {-rate * across / turn, 0, 0, rate * along / turn};
  axis.winding = W;
  return axis;
}

CoilPoint PointOnCoil(const CoilAxis& axis, double s, const Vector3d& offset) {
  const ElementPoint helix = PointOnElement(axis.beta, s);
  const math::Stumpff C = math::StumpffC(s * s * axis.beta.squaredNorm());
  const Matrix3d b = math::Cross(s * axis.beta), b2 = b * b;
  CoilPoint point;
  point.E = Matrix3d::Identity() + C[1] * b + C[2] * b2;
  const Matrix3d T = s * (Matrix3d::Identity() + C[2] * b + C[3] * b2);
  const Vector3d arm = point.E * offset;
  point.p = axis.stretch * helix.p + arm;
  point.J = Chain(axis.stretch * helix.J - math::Cross(arm) * T, helix.p, axis);
  point.T = T * axis.dbeta;
  return point;
}

CoilEnd EndOfCoil(const CoilAxis& axis) {
  const ElementEnd helix = EndOfElement(axis.beta);
  return {helix.E,
          helix.T * axis.dbeta,
          axis.stretch * helix.p,
          Chain(axis.stretch * helix.J, helix.p, axis),
          axis.stretch * helix.c,
          Chain(axis.stretch * helix.G, helix.c, axis)};
}

Vector3d BeadOffset(const Coil& coil, int g) {
  static_assert(kBeads == 4);
  // Opposite beads are of equal weight: no moment of first order, and half the radius squared of
  // second order in each direction across.
  const double r = coil.radius / (2 * std::sqrt(kBeadRule.weights[g]));
  const double sign = 2 * g < kBeads ? 1 : -1;
  const bool outer = g == 0 || g == kBeads - 1;
  return outer ? Vector3d(0, sign * r, 0) : Vector3d(0, 0, sign * r);
}

Vector3d CoilOffset(const CoilAxis& axis, double phase) {
  // y = Re(Y e^(i phase)) with (i W + [beta]) Y = slant (0, 1, -i).
  const double W = axis.winding, W2 = W * W, slant = axis.slant;
  const Vector3d& beta = axis.beta;
  const double scale = slant / (W * (W2 - beta.squaredNorm()));
  // Y = -i scale (W^2 v + i W beta x v - beta (beta.v)) with v = (0, 1, -i) = re + i im.
  const Vector3d re(0, 1, 0), im(0, 0, -1);
  const Vector3d sum_re = W2 * re - W * beta.cross(im) - beta * beta.dot(re);
  const Vector3d sum_im = W2 * im + W * beta.cross(re) - beta * beta.dot(im);
  return scale * (sum_im * std::cos(phase) + sum_re * std::sin(phase));
}

Vector3d HairOnCoil(const CoilAxis& axis, double phase, double s) {
  const double bend = axis.beta.norm(), W = axis.winding;
  if (bend < 0.5 * W) {
    const Vector3d y = CoilOffset(axis, phase + W * s);
    return PointOnCoil(axis, s, y).p - CoilOffset(axis, phase);
  }
  // Off the axis: the integral of exp(s [beta]) Re(v e^(i (phase + W s))), v = slant (0, 1, -i),
  // for the parts of v along n = beta / |beta| and across it, which turn by e^(-+i |beta| s).
  using std::complex;
  using Vector3c = Eigen::Vector3cd;
  const complex<double> i(0, 1);
  const Vector3d n = axis.beta / bend;
  const Vector3c v = axis.slant * std::exp(i * phase) * Vector3c(0, 1, -i);
  const complex<double> nv = n.cast<complex<double>>().conjugate().dot(v);
  const Vector3c along = nv * n, across = v - along;
  const Vector3c turned = i * (math::Cross(n) * v);
  const auto integral = [&](double rate) {  // Of e^(i rate s).
    const double half = 0.5 * rate * s;
    const double sinc = std::abs(half) < 1e-4 ? 1 - half * half / 6 : std::sin(half) / half;
    return s * sinc * std::exp(i * half);
  };
  const Vector3c off = integral(W) * along + 0.5 * integral(W + bend) * (across - turned) +
                       0.5 * integral(W - bend) * (across + turned);
  return axis.stretch * PointOnElement(axis.beta, s).p + off.real();
}

Vector3d CoilTangent(const CoilAxis& axis, double phase) {
  return {axis.stretch, axis.slant * std::cos(phase), axis.slant * std::sin(phase)};
}

}  // namespace mane::rod
