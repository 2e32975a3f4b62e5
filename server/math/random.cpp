#include "math/random.h"

#include <cmath>
#include <numbers>

namespace mane::math {

double RandomStream::Normal() {
  const double u = 1 - Uniform();  // In (0, 1]: its logarithm is finite.
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * Uniform());
}

}  // namespace mane::math
