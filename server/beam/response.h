#pragma once

#include <vector>

namespace mane::beam {

/// K_i [m/s^2] of segments 1 to `segments` at their middles (beam.md, B11): under a uniform
/// acceleration across it, a held hair turns as a cantilever beam does.
///
/// @param rigidity      EI [N m^2], >= 0.
/// @param line_density  rho [kg/m], > 0.
/// @param length        L [m], > 0.
[[nodiscard]] std::vector<double> HoldOf(double rigidity, double line_density, double length,
                                         int segments);

/// lambda_i [1/m] of segments of a held hair (B11): 2.1 / L at the tip, so that it swings at the
/// frequency of a cantilever beam's first mode; proportional to i as published.
[[nodiscard]] std::vector<double> ResponseOf(double length, int segments);

/// lambda_i [1/m] as published (B10).
///
/// @param segment_length  d [m]
/// @param unit            m, a length that counts as 1 in lambda: of the unit in which forces over
///                        masses are given. 1 for the numbers of [AUK92] in SI.
[[nodiscard]] std::vector<double> PublishedResponse(double segment_length, double unit,
                                                    int segments);

}  // namespace mane::beam
