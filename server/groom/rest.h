#pragma once

#include <Eigen/Core>

#include <span>

#include "groom/groom.h"
#include "rod/statics.h"

namespace mane::groom {

/// Static equilibrium of one guide, reached from its natural shape (rod::SolveRestShape).
///
/// @param gravity      [m/s^2], head frame.
/// @param coordinates  out: element angles, or unknowns of a wound guide [rad],
///                     (guide.coordinate_count()).
rod::StaticsReport SolveRest(const Guide& guide, const Eigen::Vector3d& gravity,
                             std::span<double> coordinates);

/// The natural shape: angles l kappa^n, or natural unknowns of a wound guide.
void SetNatural(const Guide& guide, std::span<double> coordinates);

}  // namespace mane::groom
