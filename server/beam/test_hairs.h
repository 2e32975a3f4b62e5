#pragma once

/// Hairs, hulls and forces for tests.

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "beam/bend.h"
#include "beam/bend_batch.h"
#include "beam/hull.h"

namespace mane::beam::fixtures {

/// Far below everything, so that nothing meets it.
inline Hull NoHull() { return {Eigen::Vector3d(0, -1e3, 0), Eigen::Vector3d::Ones()}; }

class Random {
 public:
  explicit Random(unsigned seed) : rng_(seed) {}

  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng_);
  }
  double LogUniform(double low, double high) {
    return std::exp(Uniform(std::log(low), std::log(high)));
  }
  Eigen::Vector3d Vector(double size) {
    return {Uniform(-size, size), Uniform(-size, size), Uniform(-size, size)};
  }
  Eigen::Vector3d Direction() {
    for (;;) {
      const Eigen::Vector3d v = Vector(1);
      if (v.norm() > 0.1 && v.norm() < 1) return v.normalized();
    }
  }
  /// Radii up to 5 times each other.
  Hull AnyHull() {
    const double size = LogUniform(0.01, 1);
    return {Vector(0.5), size * Eigen::Vector3d(Uniform(0.2, 1), Uniform(0.2, 1), Uniform(0.2, 1))};
  }
  /// On the hull, along its normal.
  BendHair AnyHair(const Hull& hull, double length, int segments) {
    const double zenith = std::acos(Uniform(-1, 1));
    const double azimuth = Uniform(-std::numbers::pi, std::numbers::pi);
    const Eigen::Vector3d root = hull.Point(zenith, azimuth);
    const double d = length / segments;
    return {root, hull.Gradient(root).normalized(), d,
            SoftnessOf(5e-6, d, LogUniform(1e-13, 1e-6), segments), ~0U};
  }
  Force AnyForce(const Hull& hull) {
    Force force;
    const Force::Kind kinds[] = {Force::Kind::kUniform, Force::Kind::kToward, Force::Kind::kAround};
    force.kind = kinds[rng_() % 3];
    force.vector = Vector(30);
    force.point = hull.center + 2 * hull.radii.cwiseProduct(Direction());
    force.strength = Uniform(0, 30);
    for (unsigned i = rng_() % 3; i > 0; --i) {
      const Eigen::Vector3d normal = Direction();
      force.where.emplace_back(HalfSpace{normal, normal.dot(hull.center) - Uniform(-0.1, 0.2)});
    }
    return force;
  }
  BendField AnyField(const Hull& hull, int forces) {
    BendField field;
    field.gravity = {0, -9.81, 0};
    for (int f = 0; f < forces; ++f) field.forces.emplace_back(AnyForce(hull));
    return field;
  }

 private:
  std::mt19937_64 rng_;
};

/// Nodes of hairs bent by the kernels, head frame.
template <typename T>
std::vector<std::vector<Eigen::Vector3d>> BendAll(const KernelTable<T>& kernels,
                                                  const BendBatch<T>& batch, const Hull& hull,
                                                  std::span<const BendHair> hairs) {
  std::vector<simd::Row<T>> rows(batch.hair_rows()), nodes(batch.node_rows());
  std::vector<std::vector<Eigen::Vector3d>> out;
  for (size_t first = 0; first < hairs.size(); first += simd::kLanes) {
    const size_t count = std::min<size_t>(hairs.size() - first, simd::kLanes);
    batch.Bend(kernels, hairs.subspan(first, count), rows, nodes);
    for (size_t lane = 0; lane < count; ++lane) {
      out.emplace_back();
      for (int i = 0; i <= batch.segments(); ++i) {
        out.back().emplace_back(hull.center + NodeOf<T>(nodes, static_cast<int>(lane), i));
      }
    }
  }
  return out;
}

}  // namespace mane::beam::fixtures
