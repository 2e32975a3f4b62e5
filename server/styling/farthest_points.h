#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

#include "base/cancelled.h"

namespace mane::styling {

/// Points in cells around `count` of them that lie far apart: the first point, then, each time, the
/// one that is farthest from all before. No two of those lie nearer to each other than any point
/// lies to its own.
///
/// @param count      at least 1.
/// @param cancelled  asked before each; then cells are missing, and the result is of no use.
/// @return the cell of each point, that of the nearest one of the `count`, of equally near ones the
///         first, (points). Fewer cells where so many points do not differ. O(points x count).
[[nodiscard]] std::vector<uint32_t> FarthestPointCells(std::span<const Eigen::Vector3f> points,
                                                       int count,
                                                       const base::Cancelled& cancelled = {});

}  // namespace mane::styling
