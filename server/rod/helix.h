#pragma once

#include <Eigen/Core>

#include "math/stumpff.h"

namespace mane::rod {

/// One Super-Helix element in closed form, in its own left frame (n0, n1, n2) and in units of its
/// own length, so that arc length runs over [0, 1] and the only parameter is the angle vector theta
/// = l (tau, kappa1, kappa2) [rad]. Formulas H1 to H9 of rod.md; entire functions, so that
/// straight, planar and helical elements are one case. Pure, no allocation.
///
/// Rates: dtheta moves the point at s by J(s) dtheta and turns the frame at s by the rotation
/// vector T(s) dtheta, both in left-frame coordinates.

/// Point at `s` and its Jacobian dp/dtheta.
struct ElementPoint {
  Eigen::Vector3d p;
  Eigen::Matrix3d J;
};

/// Evaluates (H3) and (H6) at `s` in [0, 1].
[[nodiscard]] ElementPoint PointOnElement(const Eigen::Vector3d& theta, double s);

/// What the far end passes on, and the centre of mass.
struct ElementEnd {
  Eigen::Matrix3d E;  ///< Right frame in the left one, exp [theta] (H2).
  Eigen::Matrix3d T;  ///< Rotation of the right frame per dtheta (H5).
  Eigen::Vector3d p;  ///< Right end (H3).
  Eigen::Matrix3d J;  ///< dp/dtheta (H6).
  Eigen::Vector3d c;  ///< Centre of mass of the centreline (H7).
  Eigen::Matrix3d G;  ///< dc/dtheta (H8).
};

/// Evaluates the end of an element.
[[nodiscard]] ElementEnd EndOfElement(const Eigen::Vector3d& theta);
/// The same for whoever has C = StumpffC(|theta|^2).
[[nodiscard]] ElementEnd EndOfElement(const Eigen::Vector3d& theta, const math::Stumpff& C);

}  // namespace mane::rod
