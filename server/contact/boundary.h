#pragma once

#include <span>
#include <vector>

#include "contact/mesh.h"

namespace mane::contact {

/// The loops of directed edges that bound `triangles`: edges from a to b counted once for every
/// triangle that has them, less those from b to a. Each loop names no vertex twice. Empty for a
/// closed mesh whose neighbours agree which way they face.
[[nodiscard]] std::vector<std::vector<uint32_t>> BoundaryLoops(std::span<const Triangle> triangles);

}  // namespace mane::contact
