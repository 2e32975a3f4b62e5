#include "styling/joint.h"

#include <algorithm>
#include <cmath>

namespace mane::styling {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kNothing = 1e-9;   // Sines and sums that are rounding.
constexpr int kTurns = 8;           // Out of what a segment enters.
constexpr double kRounding = 1e-7;  // Of positions in float32 [m].

// Of `v` across the unit n, unit; zero if there is none.
Vector3d Across(const Vector3d& v, const Vector3d& n) {
  const Vector3d across = v - v.dot(n) * n;
  const double size = across.norm();
  return size > kNothing * v.norm() ? Vector3d(across / size) : Vector3d::Zero();
}

// Along a surface of normal n: as q goes, else as q0 does, else anywhere.
Vector3d Tangent(const Vector3d& q, const Vector3d& q0, const Vector3d& n) {
  Vector3d t = Across(q, n);
  if (t.isZero()) t = Across(q0, n);
  return t.isZero() ? n.unitOrthogonal() : t;
}

}  // namespace

Vector3d BestDirection(const Vector3d& phi, double kappa, const Vector3d& q0) {
  const Vector3d sum = phi + kappa * q0;
  const double size = sum.norm();
  return size > kNothing * (phi.norm() + kappa) ? Vector3d(sum / size) : q0;
}

Force Constrained(const Force& free, double w, const Vector3d& psi) {
  const double size = free.phi.norm() + free.kappa;
  return {(1 - w) * free.phi + w * (size > 0 ? size : 1) * psi, (1 - w) * free.kappa};
}

Vector3d Turned(const Vector3d& q, const Vector3d& aim, double angle) {
  const Vector3d t = Across(aim, q);
  if (t.isZero()) return q;
  return (std::cos(angle) * q + std::sin(angle) * t).normalized();
}

Vector3d KeptOutside(const Obstacles& obstacles, const Vector3d& from, double l, double clearance,
                     const Vector3d& q0, const Vector3d& q) {
  const double wanted = clearance + kRounding;
  Vector3d best = q;
  double best_distance = -HUGE_VAL;
  const auto outside = [&](const Vector3d& direction) {
    const double distance = DistanceTo(obstacles, from + l * direction).distance;
    if (distance > best_distance) {
      best = direction;
      best_distance = distance;
    }
    return distance >= clearance;
  };
  Vector3d tried = q;
  for (int turn = 0; turn < kTurns; ++turn) {
    const contact::Distance end = DistanceTo(obstacles, from + l * tried);
    if (end.distance >= clearance) return tried;
    const double sine = tried.dot(end.normal) + (wanted - end.distance) / l;
    if (sine >= 1) {
      tried = end.normal;
      continue;
    }
    tried = (std::sqrt(1 - sine * sine) * Tangent(tried, q0, end.normal) + sine * end.normal)
                .normalized();
  }
  if (outside(tried)) return tried;
  if (outside(DistanceTo(obstacles, from).normal)) return best;
  outside(-q0);
  return best;
}

Vector3d ShortenedDetails(const Obstacles& obstacles, const Vector3d& joint,
                          const Vector3d& details, double clearance) {
  constexpr int kShares = 64;
  const auto outside = [&](int share) {
    const Vector3d point = joint + details * (static_cast<double>(share) / kShares);
    return DistanceTo(obstacles, point).distance >= clearance;
  };
  if (outside(kShares)) return details;
  int free = 0;
  for (int step = kShares / 2; step > 0; step /= 2) {
    if (outside(free + step)) free += step;
  }
  return details * (static_cast<double>(free) / kShares);
}

Quaterniond RootFrame(const Vector3d& direction) {
  const Quaterniond crown = Quaterniond::FromTwoVectors(Vector3d::UnitX(), Vector3d::UnitY());
  return (Quaterniond::FromTwoVectors(Vector3d::UnitY(), direction) * crown).normalized();
}

Quaterniond Transported(const Quaterniond& frame, const Vector3d& q) {
  const Vector3d x = frame * Vector3d::UnitX();
  return (Quaterniond::FromTwoVectors(x, q) * frame).normalized();
}

}  // namespace mane::styling
