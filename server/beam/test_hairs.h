#pragma once

/// Hairs and forces for tests of statics.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "beam/bend.h"
#include "beam/bend_batch.h"
#include "beam/hull.h"
#include "beam/packing.h"
#include "beam/test_random.h"

namespace mane::beam::fixtures {

/// Far below everything, so that nothing meets it.
inline Hull NoHull() { return {Eigen::Vector3d(0, -1e3, 0), Eigen::Vector3d::Ones()}; }

/// On the hull, along its normal.
inline BendHair AnyHair(Random& random, const Hull& hull, double length, int segments) {
  const double zenith = std::acos(random.Uniform(-1, 1));
  const double azimuth = random.Uniform(-std::numbers::pi, std::numbers::pi);
  const Eigen::Vector3d root = hull.Point(zenith, azimuth);
  const double d = length / segments;
  return {root, hull.Gradient(root).normalized(), d,
          SoftnessOf(5e-6, d, random.LogUniform(1e-13, 1e-6), segments), ~0U};
}
inline Force AnyForce(Random& random, const Hull& hull) {
  Force force;
  const Force::Kind kinds[] = {Force::Kind::kUniform, Force::Kind::kToward, Force::Kind::kAround};
  force.kind = kinds[random.Bits() % 3];
  force.vector = random.Vector(20);
  force.point = hull.center + 2 * hull.radii.cwiseProduct(random.Direction());
  force.strength = random.Uniform(0, 30);
  for (uint64_t i = random.Bits() % 3; i > 0; --i) {
    const Eigen::Vector3d normal = random.Direction();
    force.where.emplace_back(
        HalfSpace{normal, normal.dot(hull.center) - random.Uniform(-0.1, 0.2)});
  }
  return force;
}
inline BendField AnyField(Random& random, const Hull& hull, int forces) {
  BendField field;
  field.gravity = {0, -9.81, 0};
  for (int f = 0; f < forces; ++f) field.forces.emplace_back(AnyForce(random, hull));
  return field;
}

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
        out.back().emplace_back(hull.center + VectorAt(&nodes[3 * i], static_cast<int>(lane)));
      }
    }
  }
  return out;
}

}  // namespace mane::beam::fixtures
