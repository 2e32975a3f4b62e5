#pragma once

#include <memory>

#include "head/head.h"

namespace mane::head {

/// Lets the hair of `state` be beams at rest, standing still, from the beginning.
void StartBeams(std::shared_ptr<const Beams> beams, HeadState* state);

/// Changes what a head is animated by. It goes on from the shape and the motion that it has, as far
/// as the other model can hold them; what it cannot hold of what is shown is shown on, less and
/// less (Transition). Rods are at full detail then, and have forgotten what they met. No effect
/// where the head is animated so already. O(guides); allocates.
///
/// @param beams   to change to, or to another kind of them; null to change to rods.
/// @param points  of each guide in the head's frames (View::points_per_guide).
void SwitchModel(const groom::Groom& groom, std::shared_ptr<const Beams> beams, int points,
                 HeadState* state, exec::WorkerPool& pool);

}  // namespace mane::head
