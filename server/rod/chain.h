#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/helix.h"
#include "rod/strand.h"

namespace mane::rod {

/// Left end of an element in the frame of the clamp's parent.
struct ElementFrame {
  Eigen::Matrix3d R;  ///< Columns n0, n1, n2.
  Eigen::Vector3d r;  ///< Centreline [m].
};

/// Frames of all element ends, root first, tip last, (N + 1): [SH06] Appendix A, element by
/// element.
///
/// @param theta  element angles [rad], (N).
[[nodiscard]] std::vector<ElementFrame> ElementFrames(const Strand& strand, const math::Pose& clamp,
                                                      std::span<const Eigen::Vector3d> theta);

/// Where arc length `s` [m] lies: the element and the fraction of it in [0, 1]. `s` outside the
/// strand is moved to its nearer end.
struct ArcPosition {
  int element;
  double fraction;
};
[[nodiscard]] ArcPosition Locate(const Strand& strand, double s);

/// A centreline point and how it moves with the angles.
struct PointKinematics {
  Eigen::Vector3d r;  ///< [m]
  Eigen::MatrixXd J;  ///< dr/dtheta [m/rad], (3 x 3N); zero beyond the point's own element.
};

/// Point at `where` with its dense Jacobian, for statics of few points, contact and checks; the
/// time step uses none. O(N).
[[nodiscard]] PointKinematics PointAt(const Strand& strand, const math::Pose& clamp,
                                      std::span<const Eigen::Vector3d> theta, ArcPosition where);

/// Velocities at the Gauss points of every element (StrandState::velocity) of a strand of `length`
/// [m] (N) that moves with its clamp's `velocity` [m/s] and `spin` [rad/s] and changes its angles
/// at `rate` [rad/s] (N): the field B V + J v of S4. O(N).
void GaussVelocities(std::span<const double> length, const math::Pose& clamp,
                     const Eigen::Vector3d& velocity, const Eigen::Vector3d& spin,
                     std::span<const Eigen::Vector3d> theta, std::span<const Eigen::Vector3d> rate,
                     std::span<Eigen::Vector3d> result);

/// Inertia matrix of (6) for a clamp at rest, int rho S J^T J ds [kg m^2], (3N x 3N), by
/// `points`-point Gauss quadrature in each element. Dense, for checks and modal analysis.
/// [SH06] footnote 3 prints a factor 1/2, a double integral and no rho S; (4) and (5b) give this.
[[nodiscard]] Eigen::MatrixXd MassMatrix(const Strand& strand, const math::Pose& clamp,
                                         std::span<const Eigen::Vector3d> theta, int points);

}  // namespace mane::rod
