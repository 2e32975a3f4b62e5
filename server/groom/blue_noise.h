#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

namespace mane::groom {

/// Largest distance that `n` points on `area` [m^2] can all keep from each other, 2 r_max: that of
/// the hexagonal packing, with r_max = sqrt(area / (2 sqrt(3) n)) [m].
[[nodiscard]] double HexagonalDistance(double area, int n);

/// Picks the `n` of `points` that are spread most evenly, by weighted sample elimination
/// ([Yuk15] = C. Yuksel, Sample Elimination for Generating Poisson Disk Sample Sets, Computer
/// Graphics Forum 34 (2015)): while too many are left, the point with the greatest sum of weights
/// (1 - d_ij / 2 r_max)^8 over its neighbours goes, with [Yuk15]'s weight limit (beta 0.65,
/// gamma 1.5).
///
/// @param points  uniform random points on a surface [m]; five to ten times `n` give good results.
/// @param n       1 to the number of points.
/// @param area    of that surface [m^2], > 0.
/// @return indices, increasing, (n). Distances are straight lines, not geodesics. O(m log m).
[[nodiscard]] std::vector<int> EliminateToBlueNoise(std::span<const Eigen::Vector3d> points, int n,
                                                    double area);

}  // namespace mane::groom
