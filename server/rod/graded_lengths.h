#pragma once

#include <vector>

#include "rod/strand.h"

namespace mane::rod {

/// What decides where along a strand elements are needed.
struct Grading {
  double length = 0;          ///< L [m], > 0.
  double stiffness = 0;       ///< (EI) of the softer bending [N m^2], > 0.
  double linear_density = 0;  ///< rho S [kg/m], > 0.
  double curl = 0;            ///< Size of the natural (twist, curvatures) [rad/m].
  bool wound = false;         ///< The elements follow the axis of the coil (coil.md).
};

/// Gravito-bending number rho S g L^3 / EI under standard gravity: above a few, weight rather than
/// stiffness shapes the strand.
[[nodiscard]] double GravitoBendingNumber(const Grading& grading);

/// Lengths of `N` >= 1 elements, root to tip [m], short where hair bends most (rod.md, Element
/// lengths): half of them go to the layer next to the root in which heavy straight hair turns down,
/// sqrt(EI / (rho S g L)) thick, and half evenly along the strand. Light straight hair is nearly
/// even. Hair that curls by more than a turn must resolve its curls everywhere and grows by a
/// factor 4 from root to tip, wound hair as coil.md has it. They are for any clamp and any motion;
/// their sum is L to rounding.
[[nodiscard]] std::vector<double> GradedLengths(const Grading& grading, int N);

}  // namespace mane::rod
