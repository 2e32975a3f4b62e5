#pragma once

#include <Eigen/Core>

#include "styling/solver.h"

namespace mane::styling::fixtures {

/// A head: an ellipsoid of human size.
Obstacles Head();

/// Wisps on the upper half of that head by a golden spiral, hair leaving along the normal, with
/// `strands` strands each, no details, gravity of size 1.
struct Hair {
  SolverInput input;
  Masters masters;
};
Hair HairOn(const Obstacles& head, int wisps, int segments, double segment_length, float strands);

/// One wisp at a place, in empty space.
Hair WispAt(const Eigen::Vector3d& root, const Eigen::Vector3d& direction, int segments,
            double segment_length);
/// Adds one.
void AddWisp(Hair* hair, const Eigen::Vector3d& root, const Eigen::Vector3d& direction,
             int segments, float strands);

/// Deform by `workers` threads; it must not fail.
Deformed Solve(Hair* hair, int workers = 1);

}  // namespace mane::styling::fixtures
