#include "beam/highlight.h"

#include <algorithm>
#include <cmath>

namespace mane::beam {
namespace {

// Of |L + V|: less is rounding of unit vectors.
constexpr double kOpposite = 1e-7;

}  // namespace

double Specular(const Eigen::Vector3d& tangent, const Eigen::Vector3d& to_light,
                const Eigen::Vector3d& to_eye, const Shine& shine) {
  const Eigen::Vector3d between = to_light + to_eye;
  const double size = between.norm();
  if (size < kOpposite) return 0;
  const double along = tangent.dot(between) / size;
  return shine.specular * std::pow(std::max(0.0, 1 - along * along), 0.5 * shine.exponent);
}

Highlight HighlightOf(const Eigen::Vector3d& tangent, const Eigen::Vector3d& to_light,
                      const Eigen::Vector3d& to_eye, const Shine& shine, double factor) {
  return {shine.ambient_intensity * shine.ambient * factor,
          shine.light_intensity * Specular(tangent, to_light, to_eye, shine)};
}

}  // namespace mane::beam
