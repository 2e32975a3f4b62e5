#pragma once

#include "exec/worker_pool.h"
#include "head/head.h"

namespace mane::head {

/// What the hair of a head holds at one moment, for those who tune or doubt it.
struct Diagnostics {
  double kinetic_energy = 0;  ///< [SH06] (5b) [J]
  double elastic_energy = 0;  ///< [SH06] (5c) [J]; 0 in the natural shape.
  double gravity_energy = 0;  ///< Of weight [J]; 0 where every point lies as high as its root.
  /// Largest |theta| of an element [rad].
  double largest_angle = 0;
  /// How far the guide furthest from static equilibrium is from it: the largest |dE/dtheta| over
  /// the largest moment that its weight can exert, rho S |g| L^2 / 2, or the stiffest element's K
  /// times a radian without weight. At rest as small as rounding.
  double imbalance = 0;
};

/// Sums over all guides, in double precision: costs some ten time steps. The same bits for any
/// number of workers.
[[nodiscard]] Diagnostics Diagnose(const groom::Groom& groom, const HeadState& state,
                                   const Environment& environment, exec::WorkerPool& pool);

}  // namespace mane::head
