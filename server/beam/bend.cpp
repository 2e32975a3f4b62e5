#include "beam/bend.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mane::beam {
namespace {

using Eigen::Vector3d;

// Largest turn a unit of acceleration [s^2/m]; no acceleration is above 1e6, and 1e18 has a square
// in single precision.
constexpr double kSoftest = 1e12;
constexpr double kParallel = 1e-12;  // Sine below which directions are.
constexpr int kHalvings = 60;

Vector3d Across(const Vector3d& a, const Vector3d& unit) { return a - a.dot(unit) * unit; }

// The unit vector of the first candidate that has a direction across `unit`.
Vector3d FirstAcross(const Vector3d& unit, const Vector3d& first, const Vector3d& second) {
  for (const Vector3d& candidate : {first, second}) {
    const Vector3d across = Across(candidate, unit);
    if (across.norm() > kParallel) return Across(across.normalized(), unit).normalized();
  }
  const bool steep = std::abs(unit.y()) > std::sqrt(0.9);
  const Vector3d axis = steep ? Vector3d(-1, 0, 0) : Vector3d(0, 1, 0);
  return axis.cross(unit).normalized();
}

// B6, for a node inside in direction `bent`: angles in the plane count from its outward direction.
Vector3d TurnOut(const Hull& hull, const Vector3d& p, double d, const Vector3d& before,
                 const Vector3d& bent) {
  const Vector3d normal = hull.Gradient(p).normalized();
  const Vector3d side = FirstAcross(bent, before, normal);
  const double along = normal.dot(bent), up = normal.dot(side), size = std::hypot(along, up);
  if (size < kParallel) return normal;
  const Vector3d outward = (along * bent + up * side) / size;
  const Vector3d level = (std::abs(up) * bent + std::copysign(std::abs(along), up) * side) / size;
  const auto direction = [&](double angle) {
    return Vector3d(std::cos(angle) * outward + std::sin(angle) * level);
  };
  double out = std::numbers::pi / 2, in = std::atan2(bent.dot(level), bent.dot(outward));
  if (hull.At(p + d * direction(out)) < 0) in = out, out = 0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (out + in) / 2;
    (hull.At(p + d * direction(middle)) < 0 ? in : out) = middle;
  }
  return direction(out);
}

}  // namespace

double SoftnessOf(double line_density, double segment_length, double rigidity, int segments) {
  const double d = segment_length, most = 2.0 * segments * segments;  // Above any weight.
  return std::min(line_density * d * d * d / (4 * rigidity), kSoftest / most);
}

std::vector<double> TurnWeights(int segments) {
  std::vector<double> weights;
  double before = 0;
  for (int n = segments; n > 0; --n) {
    const double square = static_cast<double>(n) * n;
    weights.emplace_back(before + square);
    before = square;
  }
  return weights;
}

Vector3d AccelerationAt(const BendField& field, uint32_t mask, const Hull& hull,
                        const Vector3d& point) {
  Vector3d a = field.gravity;
  for (size_t f = 0; f < field.forces.size(); ++f) {
    const Force& force = field.forces[f];
    const auto holds = [&](const HalfSpace& half) { return half.normal.dot(point) >= half.offset; };
    if ((mask >> f & 1) == 0 || !std::ranges::all_of(force.where, holds)) continue;
    const Vector3d way = force.point - point;
    const Vector3d pull = force.strength / std::max(way.norm(), force.softening) * way;
    switch (force.kind) {
      case Force::Kind::kUniform:
        a += force.vector;
        break;
      case Force::Kind::kToward:
        a += pull;
        break;
      case Force::Kind::kAround:
        a += Across(pull, hull.Gradient(point).normalized());
        break;
    }
  }
  return a;
}

// E + 1 is a sum of squares near 1: it rounds by a few epsilon, and so do the radii's inverses. A
// node that rounds by half an epsilon of a float of each coordinate, which is at most |center| + r
// near the hull, moves E by sqrt(3) epsilon (|center| + r) / r_min. Radii that grow by a share
// lift E by twice that.
Hull Lifted(const Hull& hull, double epsilon) {
  constexpr double kRounding = std::numeric_limits<float>::epsilon();
  const double least = hull.radii.minCoeff();
  const double largest = hull.center.cwiseAbs().maxCoeff() + hull.radii.maxCoeff();
  return {hull.center, hull.radii * (1 + 8 * epsilon + 2 * kRounding * largest / least)};
}

std::vector<Vector3d> Bend(const BendHair& hair, const BendField& field,
                           std::span<const double> weights, const Hull& hull) {
  const double d = hair.segment_length;
  std::vector<Vector3d> nodes = {hair.root};
  Vector3d e = hair.direction;
  for (const double weight : weights) {
    const Vector3d p = nodes.back(), a = AccelerationAt(field, hair.forces, hull, p);
    const double along = a.dot(e);
    double turn = weight * hair.softness;
    if (along > 0) turn = std::min(turn, 1 / along);
    const Vector3d bent = (e + turn * Across(a, e)).normalized();
    e = hull.At(p + d * bent) < 0 ? TurnOut(hull, p, d, e, bent) : bent;
    nodes.emplace_back(p + d * e);
  }
  return nodes;
}

}  // namespace mane::beam
