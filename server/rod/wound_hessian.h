#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/chain_hessian.h"
#include "rod/coil_element.h"
#include "rod/wound.h"

namespace mane::rod {

/// ElasticEnergy + GravityPotential of a wound strand at one shape, with its derivatives.
class WoundHessian : public ChainHessian<4> {
 public:
  /// Evaluates at `x` [rad], (N). O(N).
  ///
  /// @param gravity  [m/s^2], in the frame of `clamp`'s parent; only the clamp's rotation matters.
  void Linearize(const WoundStrand& wound, const math::Pose& clamp, const Eigen::Vector3d& gravity,
                 std::span<const Vector4d> x);

 private:
  std::vector<CoilAxis> axes_;
  std::vector<CoilEnd> ends_;
};

}  // namespace mane::rod
