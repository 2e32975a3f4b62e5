#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "styling/obstacles.h"

namespace mane::styling {

/// The unit q that maximises phi . q + kappa q0 . q, which is (5) of [CK05]: the direction of
/// phi + kappa q0 (D6). Where that vanishes to rounding all directions are equally good, and the
/// joint stays straight: q0.
///
/// @param q0  unit.
[[nodiscard]] Eigen::Vector3d BestDirection(const Eigen::Vector3d& phi, double kappa,
                                            const Eigen::Vector3d& q0);

/// (7), with bending (D7): phi and kappa weaken by 1 - w, and w psi joins them in the size of what
/// they may be together, so that w means the same share whatever kappa.
struct Force {
  Eigen::Vector3d phi = Eigen::Vector3d::Zero();
  double kappa = 0;
};
[[nodiscard]] Force Constrained(const Force& free, double w, const Eigen::Vector3d& psi);

/// The unit vector by `angle` [rad] from the unit `q` toward `aim`, any vector; q itself if aim is
/// parallel to it.
[[nodiscard]] Eigen::Vector3d Turned(const Eigen::Vector3d& q, const Eigen::Vector3d& aim,
                                     double angle);

/// A segment of length `l` from `from` that ends `clearance` or more outside `obstacles`.
///
/// Turns q out of the tangent plane of what it enters, which leaves a convex solid in one step
/// (D10), and up to eight for others; then tries the normal at `from`, and at last `-q0`, back to
/// the joint before.
///
/// @param q0         direction of the segment before, or of a root's hair; unit.
/// @param clearance  [m], below l.
/// @return unit; if even the last fails, the least deep of all.
[[nodiscard]] Eigen::Vector3d KeptOutside(const Obstacles& obstacles, const Eigen::Vector3d& from,
                                          double l, double clearance, const Eigen::Vector3d& q0,
                                          const Eigen::Vector3d& q);

/// What of a control point's `details`, head frame [m], keeps it `clearance` outside: details
/// times the largest of 64 equal shares up to 1 by bisection; none if nothing does.
[[nodiscard]] Eigen::Vector3d ShortenedDetails(const Obstacles& obstacles,
                                               const Eigen::Vector3d& joint,
                                               const Eigen::Vector3d& details, double clearance);

/// Frame of a root whose hair leaves along the unit `direction`: x along it, turned the least from
/// hair at the crown, so that it varies smoothly over the scalp but for straight down.
[[nodiscard]] Eigen::Quaterniond RootFrame(const Eigen::Vector3d& direction);

/// `frame` turned the least so that its x axis comes to lie along the unit `q`.
[[nodiscard]] Eigen::Quaterniond Transported(const Eigen::Quaterniond& frame,
                                             const Eigen::Vector3d& q);

}  // namespace mane::styling
