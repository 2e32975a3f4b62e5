#pragma once

#include <Eigen/Core>

#include <span>

#include "math/rigid.h"
#include "rod/strand.h"

namespace mane::rod {

/// How a search for equilibrium ended.
struct StaticsReport {
  double residual = 0;  ///< StaticsResidual(); at most 1e-9 where `converged`.
  int iterations = 0;
  bool converged = false;
};

/// How far a shape is from equilibrium: the largest component of its `gradient` dE/dtheta [J], (N),
/// over the largest of these moments: what the strand's weight can exert, rho S |g| L^2 / 2; what
/// bends and twists it into its natural shape, (EI)_i |kappa^n_i|; and, so that it is never zero,
/// the smallest (EI)_i / L.
[[nodiscard]] double StaticsResidual(const Strand& strand, const Eigen::Vector3d& gravity,
                                     std::span<const Eigen::Vector3d> gradient);

/// Static equilibrium: the local minimum of U(theta) - int rho S g.r ds that energy descent reaches
/// from the given angles (heavy and upward hair has several; see rod.md, Statics).
///
/// O(N) an iteration.
///
/// @param clamp    root frame; only its rotation matters.
/// @param gravity  [m/s^2], in the frame of `clamp`'s parent.
/// @param theta    in: where to start, such as the natural shape; out: the equilibrium [rad], (N).
StaticsReport SolveRestShape(const Strand& strand, const math::Pose& clamp,
                             const Eigen::Vector3d& gravity, std::span<Eigen::Vector3d> theta);

}  // namespace mane::rod
