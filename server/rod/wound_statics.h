#pragma once

#include <Eigen/Core>

#include <span>

#include "rod/statics.h"
#include "rod/wound.h"

namespace mane::rod {

/// As statics.h's of a plain strand, from the gradient by x [J], (N).
[[nodiscard]] double StaticsResidual(const WoundStrand& wound, const Eigen::Vector3d& gravity,
                                     std::span<const Vector4d> gradient);

/// Static equilibrium of a wound strand, as statics.h's of a plain one: the local minimum of
/// U(x) - int rho S g.r ds that energy descent reaches from `x`. O(N) an iteration.
///
/// @param clamp    root frame of the hair; only its rotation matters.
/// @param gravity  [m/s^2], in the frame of `clamp`'s parent.
/// @param x        in: where to start, such as the natural shape; out: the equilibrium [rad], (N).
StaticsReport SolveRestShape(const WoundStrand& wound, const math::Pose& clamp,
                             const Eigen::Vector3d& gravity, std::span<Vector4d> x);

}  // namespace mane::rod
