#include "rod/wound_statics.h"

#include "base/check.h"
#include "rod/descent.h"
#include "rod/wound_hessian.h"

namespace mane::rod {

using Eigen::Vector3d;

double StaticsResidual(const WoundStrand& wound, const Vector3d& gravity,
                       std::span<const Vector4d> gradient) {
  return descent::Residual(wound.strand, gravity, gradient);
}

StaticsReport SolveRestShape(const WoundStrand& wound, const math::Pose& clamp,
                             const Vector3d& gravity, std::span<Vector4d> x) {
  MANE_CHECK(static_cast<int>(x.size()) == wound.elements());
  const auto linearize = [&](WoundHessian& hessian, std::span<const Vector4d> at) {
    hessian.Linearize(wound, clamp, gravity, at);
  };
  return descent::Descend<WoundHessian>(wound.strand, gravity, linearize, x);
}

}  // namespace mane::rod
