#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/chain_hessian.h"
#include "rod/helix.h"
#include "rod/strand.h"

namespace mane::rod {

/// ElasticEnergy + GravityPotential of a strand at one shape, with its derivatives. Without weight
/// the lowest eigenvalue is 1.
class PotentialHessian : public ChainHessian<3> {
 public:
  /// Evaluates at `theta` [rad], (N). O(N).
  ///
  /// @param gravity  [m/s^2], in the frame of `clamp`'s parent; only the clamp's rotation matters.
  void Linearize(const Strand& strand, const math::Pose& clamp, const Eigen::Vector3d& gravity,
                 std::span<const Eigen::Vector3d> theta);

 private:
  std::vector<ElementEnd> ends_;
};

}  // namespace mane::rod
