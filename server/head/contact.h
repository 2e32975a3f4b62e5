#pragma once

#include <memory>
#include <vector>

#include "head/bodies.h"
#include "math/rigid.h"
#include "rod/batch.h"

namespace mane::head {

/// What a head's hair meets, and what is remembered of it from step to step.
struct Contact {
  std::shared_ptr<const Bodies> bodies;  ///< Null before StartContact: hair meets nothing.
  std::vector<math::Pose> moving;        ///< World poses of its moving bodies, (moving_count).
};

struct HeadState;

/// Lets the hair of `state` meet `bodies` from the next Advance on; the moving ones are where they
/// are at rest. Allocates.
void StartContact(const groom::Groom& groom, std::shared_ptr<const Bodies> bodies,
                  HeadState* state);

}  // namespace mane::head
