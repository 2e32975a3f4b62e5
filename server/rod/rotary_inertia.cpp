#include "rod/rotary_inertia.h"

#include <algorithm>

#include "rod/graded_lengths.h"
#include "rod/scheme.h"

namespace mane::rod {

double RotaryInertia(const Strand& strand) {
  const double number = GravitoBendingNumber({.length = strand.TotalLength(),
                                              .stiffness = strand.stiffness.tail<2>().minCoeff(),
                                              .linear_density = strand.linear_density});
  const double apart = kGauss.nodes[2] - kGauss.nodes[0];
  return std::min(1.0, 4 / number) / 24 / (apart * apart);
}

}  // namespace mane::rod
