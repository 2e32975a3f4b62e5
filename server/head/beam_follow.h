#pragma once

#include <Eigen/Core>

#include <span>

#include "groom/groom.h"
#include "head/beams.h"

namespace mane::head {

/// Coordinates of a rod that follows a beam: element by element the end of the rod, or of a wound
/// one's axis, is turned from where it is at rest as the beam there is, by bends alone: twist and
/// winding are those at rest. Beams in their rest directions give the coordinates at rest.
///
/// @param directions   of the beam's segments, unit, head frame, (segments).
/// @param coordinates  (Guide::coordinate_count) [rad].
void FollowBeam(const groom::Groom& groom, const Beams& beams, int guide,
                std::span<const Eigen::Vector3d> directions, std::span<double> coordinates);

}  // namespace mane::head
