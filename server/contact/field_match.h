#pragma once

#include <array>

#include "contact/field_grid.h"

namespace mane::contact {

/// Side of a root cell, in sides of the smallest cells there may be.
inline constexpr int kUnits = 64;

/// Makes a field continuous across cells of different size: corners of cells of `step` units, in
/// the divided root cell at `root`, that touch a larger cell take over what that one says there.
/// (D14) shows that then both say the same all over their common face.
///
/// To be called for all roots with a step before the next smaller one, in any order and at once.
void MatchRoot(const std::array<int, 3>& root, int step, FieldGrid* grid);

}  // namespace mane::contact
