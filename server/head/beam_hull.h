#pragma once

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

#include "exec/worker_pool.h"
#include "head/beams.h"
#include "math/rigid.h"

namespace mane::head {

/// Of guides, the part that may lie in the hull at rest.
inline constexpr double kInHull = 0.05;

/// The ellipsoid that beams stay out of (B6): that of the groom's scalp (groom::ScalpHull), as much
/// smaller as leaves outside all nodes at rest of all guides but kInHull of them: one that hangs
/// through the head takes nothing from the others. Empty where there is no scalp, or one that no
/// ellipsoid comes near.
///
/// @param beams  with segments, segment_length and directions.
[[nodiscard]] std::optional<beam::Hull> HullOf(const groom::Groom& groom, const Beams& beams);

/// Directions that a step would leave out of the hull, and joints that turn no further than they
/// may: hair that stands still under no force takes one, too short to matter.
///
/// @param beams       with batch and rest.
/// @param directions  world, unit, (guides x segments).
void KeepOut(const Beams& beams, const math::Pose& head, std::vector<Eigen::Vector3d>* directions,
             exec::WorkerPool& pool);

/// Guides some of whose nodes at rest, but roots, are in the hull.
[[nodiscard]] std::vector<int> GuidesInside(const groom::Groom& groom, const Beams& beams,
                                            const beam::Hull& hull);

}  // namespace mane::head
