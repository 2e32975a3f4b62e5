#include "rod/wound_hessian.h"

#include "base/check.h"
#include "rod/helix.h"
#include "rod/second_derivative.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

struct WoundElements {
  const WoundStrand& wound;
  std::span<const Vector4d> x;
  std::span<const CoilAxis> axes;

  [[nodiscard]] Matrix4d Stiffness(int Q) const {
    return wound.coil[Q].stiffness / wound.strand.length[Q];
  }
  [[nodiscard]] Vector4d Strain(int Q) const { return x[Q] - wound.natural[Q]; }

  // C11: of lambda f(beta) + h(beta) with f = w.(u p_H + v c_H), h = w.E a.
  [[nodiscard]] Matrix4d SecondDerivative(int Q, const Vector3d& w, double u, double v,
                                          const Vector3d& a) const {
    const CoilAxis& axis = axes[Q];
    const double lambda = axis.stretch, turn = axis.winding + axis.beta[0];
    const ElementEnd helix = EndOfElement(axis.beta);
    const double f = w.dot(u * helix.p + v * helix.c);
    const Vector3d df = (u * helix.J + v * helix.G).transpose() * w;
    const Vector3d dh = helix.T.transpose() * (helix.E * a).cross(w);
    const Matrix3d by_beta = rod::SecondDerivative(axis.beta, w, lambda * u, lambda * v, a);
    // Of the strain in the (axis, w) plane: along and across it.
    const Vector4d n = axis.dbeta.row(0), t(-n[3], 0, 0, n[0]);
    const Vector4d mixed = axis.slant / turn * (axis.dbeta.transpose() * df - f / turn * n);
    const double turned = (lambda * (df[0] - f / turn) + dh[0]) / turn;
    return axis.dbeta.transpose() * by_beta * axis.dbeta + mixed * t.transpose() +
           t * mixed.transpose() + turned * t * t.transpose();
  }
};

}  // namespace

void WoundHessian::Linearize(const WoundStrand& wound, const math::Pose& clamp,
                             const Vector3d& gravity, std::span<const Vector4d> x) {
  const int N = wound.elements();
  MANE_CHECK(static_cast<int>(x.size()) == N);
  axes_.resize(N);
  ends_.resize(N);
  for (int Q = 0; Q < N; ++Q) {
    axes_[Q] = AxisOfElement(wound.coil[Q], wound.strand.length[Q], x[Q]);
    ends_[Q] = EndOfCoil(axes_[Q]);
  }
  Assemble<CoilEnd>(wound.strand, clamp.q * wound.coil[0].F, gravity, ends_,
                    WoundElements{wound, x, axes_});
  energy_ -=
      wound.strand.linear_density * wound.strand.TotalLength() * gravity.dot(clamp.q * wound.root);
}

}  // namespace mane::rod
