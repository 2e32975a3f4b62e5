#pragma once

#include <Eigen/Core>

namespace mane::rod {

/// Second derivative by theta of w.(u p + v c + E a), 3 x 3, where p, c, E are the end, the centre
/// of mass and the rotation of a Super-Helix element of angles `theta` [rad] (rod.md, Q2), and a
/// does not change with theta.
[[nodiscard]] Eigen::Matrix3d SecondDerivative(const Eigen::Vector3d& theta,
                                               const Eigen::Vector3d& w, double u, double v,
                                               const Eigen::Vector3d& a);

}  // namespace mane::rod
