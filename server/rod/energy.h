#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/strand.h"

namespace mane::rod {

/// U of [SH06] (5c) [J]: 1/2 sum_Q (EI)_i / l_Q (theta_i - theta^n_i)^2 in element angles.
[[nodiscard]] double ElasticEnergy(const Strand& strand, std::span<const Eigen::Vector3d> theta);

/// -int rho S g.(r - r_clamp) ds [J], exact for a piecewise helix (H7).
[[nodiscard]] double GravityPotential(const Strand& strand, const math::Pose& clamp,
                                      const Eigen::Vector3d& gravity,
                                      std::span<const Eigen::Vector3d> theta);

/// Gradient of ElasticEnergy + GravityPotential by theta [J/rad], (N); O(N).
void PotentialGradient(const Strand& strand, const math::Pose& clamp,
                       const Eigen::Vector3d& gravity, std::span<const Eigen::Vector3d> theta,
                       std::span<Eigen::Vector3d> gradient);

/// T of [SH06] (5b) [J], with what S12 adds, from velocities [m/s] at the Gauss points of every
/// element, (N x kGaussPoints), as in StrandState::velocity.
[[nodiscard]] double KineticEnergy(const Strand& strand, std::span<const Eigen::Vector3d> velocity);

}  // namespace mane::rod
