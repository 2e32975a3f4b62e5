#pragma once

#include <cstddef>

#include "groom/groom.h"
#include "head/model.h"

namespace mane::head {

/// What hair of a groom meets, counted.
struct BodyCount {
  int bodies = 0;  ///< The scalp among them, where hair meets it.
  int groups = 0;  ///< That move on their own (Bodies::groups).
};
[[nodiscard]] BodyCount CountBodies(const groom::Groom& groom);

/// Memory of a HeadState of `groom` at full detail [bytes]: shapes and velocities of guides, and at
/// every point what was seen of every group. Pairs of wisps come on top while wisps touch, some
/// 16 kB a guide. O(elements).
[[nodiscard]] size_t StateBytes(const groom::Groom& groom);

/// Memory that beams take [bytes]: what moves of one head, and Beams, which other heads of the same
/// options share. O(1).
[[nodiscard]] size_t BeamBytes(const groom::Groom& groom, const BeamOptions& options);

}  // namespace mane::head
