#include "beam/bend.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mane::beam {
namespace {

using Eigen::Vector3d;

// Largest turn a unit of acceleration [s^2/m]; no acceleration is above 1e6, and 1e18 has a square
// in single precision.
constexpr double kSoftest = 1e12;
constexpr double kParallel = 1e-12;  // Sine below which directions are.
constexpr int kHalvings = 60;

// Square of what a plane must have of the normal.
constexpr double kLying = 1e-4;

Vector3d Across(const Vector3d& a, const Vector3d& unit) { return a - a.dot(unit) * unit; }

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
    const auto holds = [&](const HalfSpace& half) { return half.HeightOf(point) >= 0; };
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

Vector3d TurnedOut(const Hull& hull, const Vector3d& p, double d, const Vector3d& before,
                   const Vector3d& e) {
  const Vector3d normal = hull.Gradient(p).normalized();
  Vector3d side = Across(before, e);
  const bool parallel = side.norm() < kParallel;
  side = Across(side.normalized(), e).normalized();
  const auto outward = [&] { return Vector3d(normal.dot(e) * e + normal.dot(side) * side); };
  if (parallel || outward().squaredNorm() < kLying) {
    const Vector3d up = Across(normal, e);
    side = up.norm() < kParallel ? e.unitOrthogonal() : Across(up.normalized(), e).normalized();
  }
  // Angles count from s, level with the hull on the side of e, away from t, outward.
  const Vector3d t = outward().normalized();
  const double up = t.dot(side), along = t.dot(e);
  const Vector3d s = std::abs(up) * e - std::copysign(1.0, up) * along * side;
  const auto direction = [&](double psi) {
    return Vector3d(std::cos(psi) * s - std::sin(psi) * t);
  };
  const auto is_out = [&](double psi) { return hull.At(p + d * direction(psi)) >= 0; };
  const double psi = std::atan2(-along, std::abs(up));
  const bool level_is_out = psi > 0 && is_out(0);
  double out = level_is_out ? 0 : -std::numbers::pi / 2,
         in = level_is_out ? psi : std::min(psi, 0.0);
  if (!is_out(out)) return normal;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (out + in) / 2;
    (is_out(middle) ? out : in) = middle;
  }
  return direction(out);
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
    e = hull.At(p + d * bent) < 0 ? TurnedOut(hull, p, d, e, bent) : bent;
    nodes.emplace_back(p + d * e);
  }
  return nodes;
}

}  // namespace mane::beam
