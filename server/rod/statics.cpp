#include "rod/statics.h"

#include "base/check.h"
#include "rod/descent.h"
#include "rod/hessian.h"

namespace mane::rod {

using Eigen::Vector3d;

double StaticsResidual(const Strand& strand, const Vector3d& gravity,
                       std::span<const Vector3d> gradient) {
  return descent::Residual(strand, gravity, gradient);
}

StaticsReport SolveRestShape(const Strand& strand, const math::Pose& clamp, const Vector3d& gravity,
                             std::span<Vector3d> theta) {
  MANE_CHECK(static_cast<int>(theta.size()) == strand.elements());
  const auto linearize = [&](PotentialHessian& hessian, std::span<const Vector3d> at) {
    hessian.Linearize(strand, clamp, gravity, at);
  };
  return descent::Descend<PotentialHessian>(strand, gravity, linearize, theta);
}

}  // namespace mane::rod
