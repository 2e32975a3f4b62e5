#pragma once

#include <Eigen/Core>

namespace mane::contact {

/// How hair rubs on a surface ([SH06] 2.2, 4.2). The scales of a hair point to its tip: what moves
/// along it from root to tip glides, what moves the other way is held.
struct Friction {
  double coefficient = 0.3;  ///< Coulomb's mu across the hair; [0, 10].
  /// By how much of it mu rises where the hair slides towards its tip, and falls where it slides
  /// towards its root; [0, 1].
  double anisotropy = 0.25;

  /// mu for hair of the unit tangent `tangent` (root to tip) that slides with `velocity` over the
  /// surface, any size: coefficient (1 + anisotropy cos(angle between the two)); the cosine law of
  /// [SH06] 4.2. Where nothing slides, that across.
  [[nodiscard]] double Coefficient(const Eigen::Vector3d& velocity,
                                   const Eigen::Vector3d& tangent) const {
    const double speed = velocity.norm();
    if (!(speed > 0)) return coefficient;
    return coefficient * (1 + anisotropy * velocity.dot(tangent) / speed);
  }
};

}  // namespace mane::contact
