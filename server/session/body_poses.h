#pragma once

#include <optional>
#include <vector>

#include "head/bodies.h"
#include "math/rigid.h"

namespace mane::session {

/// World poses that a client gave to a head's moving bodies, (Bodies::moving_count), in the groom's
/// order; none for a body that it did not name. Empty where it named none.
using BodyPoses = std::vector<std::optional<math::Pose>>;

/// Takes what `change` names into `poses`.
void Apply(const BodyPoses& change, BodyPoses* poses);

/// Where all moving bodies are on a head at `head`: where `named` has them, else at rest on it.
///
/// @param bodies  null for none.
[[nodiscard]] std::vector<math::Pose> PlaceBodies(const head::Bodies* bodies,
                                                  const math::Pose& head, const BodyPoses& named);

}  // namespace mane::session
