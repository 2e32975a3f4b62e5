#pragma once

#include <cstdint>
#include <span>

#include "base/cancelled.h"
#include "exec/worker_pool.h"
#include "styling/hairstyle.h"
#include "styling/obstacles.h"
#include "styling/style.h"

namespace mane::styling {

/// What the outline of a master of `master_length` must be made long [m] so that its members,
/// `length` times as long as it, find their way given: the longest member, and what a strand on the
/// outside of a half turn of the master needs less of it (W16). At least `master_length`.
[[nodiscard]] double Reach(const Distribution& length, double master_length,
                           std::span<const double> radii);

/// r(s) [m]: `radii` at equal distances from s = 0 to 1, linear between them, constant beyond.
[[nodiscard]] float RadiusAt(std::span<const double> radii, double s);

/// Member strands by [CK05] (1), wisps.md (W13) to (W17).
///
/// Point k of a member lies at its master's point k plus F_k d_k, with F_k the frame of joint k, so
/// that a wisp keeps its cross section around bends. d_1 is what leads from the master's root to
/// the member's; all later |d_k| are at most r_k, the radius there. A member's polyline is u times
/// as long as its master's to rounding, u drawn from `length`: its last segment is cut, and made
/// one with the one before where less than half of that is left of it. Where the master's joints
/// end before, the last segment is drawn out straight. Every strand has two points or more.
///
/// No control point but roots is inside an obstacle, to 1e-6 m, where the master's points are
/// outside: a displacement that leads inside is shortened, a tip inside is turned out.
///
/// @param masters    deformed; every strand has two joints or more, and the length that Reach says.
/// @param length     valid, of numbers >= 0.
/// @param radii      r(s) [m] at equal distances from root (s = 0) to tip (s = 1: the master's own
///                   length along its outline), linear between and constant beyond; one or more,
///                   each >= 0. Where it is 0 all strands meet in the master.
/// @param fuzziness  sigma >= 0; 0 scales the displacement of the root.
/// @param cancelled  asked now and then; then strands are missing, and the result is of no use.
/// @return the same bits for any number of workers; strand i depends on its wisp and (seed, i)
/// only. Memory: 12 bytes a strand and joint of its master, while it runs.
[[nodiscard]] Members MakeMembers(const Roots& roots, const Masters& masters,
                                  const Obstacles& obstacles, const Distribution& length,
                                  std::span<const double> radii, double fuzziness, uint64_t seed,
                                  exec::WorkerPool& pool, const base::Cancelled& cancelled = {});

}  // namespace mane::styling
