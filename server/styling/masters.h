#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "exec/worker_pool.h"
#include "styling/chart.h"
#include "styling/hairstyle.h"
#include "styling/style.h"

namespace mane::styling {

/// Lengths of master strands by a style's map [m], (wisps).
[[nodiscard]] std::vector<double> LengthsOf(const ScalpMap& map, const Roots& roots,
                                            const ScalpChart& chart);

/// Shortens what cuts by length do, by the numbers that wisps have in `roots`.
void CutByLength(const std::vector<Cut>& cuts, const Roots& roots, const ScalpChart& chart,
                 std::vector<double>* lengths);

/// Takes out the wisps whose masters have no length, with their members; numbers of the others
/// close up.
///
/// @param lengths  (wisps) [m]; in the same order afterwards.
void LeaveOutBald(Roots* roots, std::vector<double>* lengths);

/// Straight masters with the details of their region's prototype: joints, lengths and details are
/// set, places are up to the solver.
///
/// A master has a joint every `segment_length` as far as its members may need (Reach); its own
/// length is the map's, at least a tenth of a segment.
///
/// @param lengths     of each master [m], > 0.
/// @param max_joints  of all masters.
/// @param field       path of the style, for errors.
/// @return RESOURCE_EXHAUSTED naming `segment_length_m` above `max_joints`. The same bits for any
///   number of workers.
[[nodiscard]] Result<Masters> MakeMasters(const Style& style, const Roots& roots,
                                          const ScalpChart& chart,
                                          const std::vector<double>& lengths, long max_joints,
                                          uint64_t seed, const std::string& field,
                                          exec::WorkerPool& pool);

/// Shortens deformed masters to where they first leave a cut's half-space, on the outline between
/// its joints; at least to a tenth of a segment, as what grows beyond the plane cannot be cut away.
void CutByPlanes(const std::vector<Cut>& cuts, const Roots& roots, const ScalpChart& chart,
                 Masters* masters);

}  // namespace mane::styling
