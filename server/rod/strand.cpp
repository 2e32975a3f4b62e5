#include "rod/strand.h"

#include <numbers>
#include <numeric>

namespace mane::rod {

double Strand::TotalLength() const { return std::accumulate(length.begin(), length.end(), 0.0); }

Eigen::Vector3d Stiffness(const Section& section, const Material& material) {
  const double a = section.radius_1, b = section.radius_2, E = material.young_modulus;
  const double a3 = a * a * a, b3 = b * b * b;
  const double mu = E / (2 * (1 + material.poisson_ratio));
  return {mu * std::numbers::pi * a3 * b3 / (a * a + b * b), E * std::numbers::pi / 4 * a * b3,
          E * std::numbers::pi / 4 * a3 * b};
}

double LinearDensity(const Section& section, const Material& material) {
  return material.density * std::numbers::pi * section.radius_1 * section.radius_2;
}

}  // namespace mane::rod
