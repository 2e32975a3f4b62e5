#pragma once

#include <cmath>
#include <vector>

#include "beam/hull.h"
#include "math/random.h"

namespace mane::beam::fixtures {

/// Seeded random numbers for tests.
class Random : public math::RandomStream {
 public:
  explicit Random(uint64_t seed) : math::RandomStream(seed, 0) {}

  double LogUniform(double low, double high) {
    return std::exp(Uniform(std::log(low), std::log(high)));
  }
  /// Of normal coordinates of this deviation.
  Eigen::Vector3d Vector(double size) {
    return size * Eigen::Vector3d(Normal(), Normal(), Normal());
  }
  Eigen::Vector3d Direction() { return Vector(1).normalized(); }
  std::vector<Eigen::Vector3d> Directions(int count) {
    std::vector<Eigen::Vector3d> e;
    for (int i = 0; i < count; ++i) e.push_back(Direction());
    return e;
  }
  /// Radii up to 5 times each other.
  Hull AnyHull() {
    const double size = LogUniform(0.01, 1);
    return {Vector(0.3), size * Eigen::Vector3d(Uniform(0.2, 1), Uniform(0.2, 1), Uniform(0.2, 1))};
  }
};

}  // namespace mane::beam::fixtures
