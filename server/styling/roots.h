#pragma once

#include <cstdint>

#include "base/result.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "styling/chart.h"
#include "styling/hairstyle.h"
#include "styling/style.h"

namespace mane::styling {

/// Where hair grows ([CK05] 2.3; scalp.md, P6-P8).
///
/// Masters: blue noise by elimination (groom/blue_noise.h) among ten times as many points, drawn
/// evenly from where `density` is above 0. Their Voronoi regions are the wisps, by straight
/// distance. Members: drawn independently over the scalp, in proportion to `density`, each to the
/// wisp of its nearest master; a wisp may get none. So a wisp's count is binomial, with its share
/// of the density's integral.
///
/// @param scalp         valid and not empty; `chart` is made of it.
/// @param density       valid, nowhere below 0; only its ratios matter.
/// @param wisp_count    >= 1, and `strand_count` >= 0: come out exactly.
/// @return INVALID_ARGUMENT for `density` where it is 0 on all of the hair region, or so nearly so
///         that drawing by it would not end.
///
/// Depends on its arguments only, not on how many workers there are. Linear in strands.
[[nodiscard]] Result<Roots> PlaceRoots(const groom::Scalp& scalp, const ScalpChart& chart,
                                       const ScalpMap& density, int wisp_count, int strand_count,
                                       uint64_t seed, exec::WorkerPool& pool);

}  // namespace mane::styling
