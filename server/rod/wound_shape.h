#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/wound.h"

namespace mane::rod {

/// Left end of a wound element in the frame of the clamp's parent.
struct WoundFrame {
  Eigen::Matrix3d A;     ///< Axis frame, columns.
  Eigen::Vector3d axis;  ///< Point of the axis [m].
  Eigen::Vector3d hair;  ///< Point of the hair [m].
  double phase;          ///< Angle wound from the root, the sum of omega l [rad].
};

/// Frames of all element ends, root first, tip last, (N + 1). The hair starts at the clamp point
/// and the axis off it (C10); the hair is laid element after element, without gaps (C9).
[[nodiscard]] std::vector<WoundFrame> WoundFrames(const WoundStrand& wound, const math::Pose& clamp,
                                                  std::span<const Vector4d> x);

/// The hair's point at arc length `s` [m] from the root; `s` outside the strand is moved to its
/// nearer end. A polyline through such points is nowhere longer than the arc between them.
///
/// @param frames  those of `x`. @param x  unknowns [rad], (N).
[[nodiscard]] Eigen::Vector3d PointOnHair(const WoundStrand& wound,
                                          std::span<const WoundFrame> frames,
                                          std::span<const Vector4d> x, double s);

/// T, U and V [J] of a wound strand: kinetic energy is energy.h's, of the beads' velocities.
/// U = 1/2 sum_Q (x - x^n).K (x - x^n) / l (C6).
[[nodiscard]] double ElasticEnergy(const WoundStrand& wound, std::span<const Vector4d> x);

/// T of (5b) [J] from the velocities of the beads [m/s], (N x kBeads), as in WoundState::velocity.
[[nodiscard]] double KineticEnergy(const WoundStrand& wound,
                                   std::span<const Eigen::Vector3d> velocity);

/// -int rho S g.(r - r_clamp) ds [J] of the axis (C8).
[[nodiscard]] double GravityPotential(const WoundStrand& wound, const math::Pose& clamp,
                                      const Eigen::Vector3d& gravity, std::span<const Vector4d> x);

}  // namespace mane::rod
