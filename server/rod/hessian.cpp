#include "rod/hessian.h"

#include "base/check.h"
#include "rod/second_derivative.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct PlainElements {
  const Strand& strand;
  std::span<const Vector3d> theta;

  [[nodiscard]] Matrix3d Stiffness(int Q) const {
    return (strand.stiffness / strand.length[Q]).asDiagonal();
  }
  [[nodiscard]] Vector3d Strain(int Q) const {
    return theta[Q] - strand.length[Q] * strand.natural[Q];
  }
  [[nodiscard]] Matrix3d SecondDerivative(int Q, const Vector3d& w, double u, double v,
                                          const Vector3d& a) const {
    return rod::SecondDerivative(theta[Q], w, u, v, a);
  }
};

}  // namespace

void PotentialHessian::Linearize(const Strand& strand, const math::Pose& clamp,
                                 const Vector3d& gravity, std::span<const Vector3d> theta) {
  const int N = strand.elements();
  MANE_CHECK(static_cast<int>(theta.size()) == N);
  ends_.resize(N);
  for (int Q = 0; Q < N; ++Q) ends_[Q] = EndOfElement(theta[Q]);
  Assemble<ElementEnd>(strand, clamp.q.toRotationMatrix(), gravity, ends_,
                       PlainElements{strand, theta});
}

}  // namespace mane::rod
