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
  /// rod::StaticsResidual of the guide furthest from static equilibrium. At rest as small as the
  /// rounding of float32 angles.
  double imbalance = 0;
};

/// Sums over all guides, in double precision: costs some sixteen time steps of the AVX-512 kernel
/// (`tests/bench/run rod`), twelve of AVX2's. The same bits for any number of workers.
[[nodiscard]] Diagnostics Diagnose(const groom::Groom& groom, const HeadState& state,
                                   const Environment& environment, exec::WorkerPool& pool);

}  // namespace mane::head
