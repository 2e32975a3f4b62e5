#pragma once

#include <cstdint>
#include <vector>

#include "groom/groom.h"
#include "groom/hair_region.h"

namespace mane::groom {

/// Area of the hair region [m^2]; 0 without a scalp. Indices of a mesh must be in range.
[[nodiscard]] double HairArea(const Scalp& scalp);

/// Exactly `n` points spread evenly at random over the hair region: blue noise by sample
/// elimination among ten times as many uniform points. The smallest distance comes out near 0.74 of
/// HexagonalDistance (0.695 among five times as many, a quarter of the time). Depends on `scalp`,
/// `n` and `seed` only.
///
/// @param scalp  valid (ValidateScalp) and not empty. On an ellipsoid density is even as long as
/// its
///               radii are within a factor of about ten of each other.
/// @param n      >= 1.
[[nodiscard]] std::vector<ScalpPoint> SampleScalp(const Scalp& scalp, int n, uint64_t seed);

}  // namespace mane::groom
