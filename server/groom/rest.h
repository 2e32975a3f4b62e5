#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "groom/groom.h"
#include "rod/statics.h"

namespace mane::groom {

/// The natural shape: angles l kappa^n of the elements, or natural unknowns of a wound guide [rad],
/// (guide.coordinate_count()).
[[nodiscard]] std::vector<double> NaturalShape(const Guide& guide);

/// Static equilibrium of one guide (rod::SolveRestShape).
///
/// @param gravity      [m/s^2], head frame.
/// @param coordinates  in: where to start; out: the equilibrium; as NaturalShape.
rod::StaticsReport SolveRest(const Guide& guide, const Eigen::Vector3d& gravity,
                             std::span<double> coordinates);

/// By how much the direction of a guide turns from root to tip in a shape [rad], the integral of
/// its curvature without twist. Of a wound guide, whose coils hardly unwind, that of its natural
/// shape.
///
/// @param coordinates  as NaturalShape.
[[nodiscard]] double Turning(const Guide& guide, std::span<const double> coordinates);

}  // namespace mane::groom
