#pragma once

#include "rod/strand.h"

namespace mane::rod {

/// What the elements of a plain strand resist turning by beyond what their mass does (rod.md, S12):
/// mu of the term 1/2 mu m |u_2 - u_0|^2 of an element's kinetic energy, u_0 and u_2 the velocities
/// at its outer Gauss points. 0 for heavy hair to 5/72 for light hair, whose first natural
/// frequency is then right however few its elements are. O(N).
[[nodiscard]] double RotaryInertia(const Strand& strand);

}  // namespace mane::rod
