#include "math/rigid.h"

#include <cmath>

namespace mane::math {

Eigen::Vector3d RotationVector(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1 : 1;  // The shorter of the two arcs.
  const Eigen::Vector3d v = sign * q.vec();
  const double sine = v.norm();
  if (sine < 1e-12) return 2 * v;
  return (2 * std::atan2(sine, sign * q.w()) / sine) * v;
}

Eigen::Quaterniond FromRotationVector(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  const double half = 0.5 * angle;
  const double sinc = angle < 1e-8 ? 0.5 : std::sin(half) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(half);
  q.vec() = sinc * v;
  return q.normalized();
}

Pose Interpolate(const Pose& a, const Pose& b, double u) {
  const Eigen::Vector3d turn = RotationVector(a.q.conjugate() * b.q);
  return {a.p + u * (b.p - a.p), (a.q * FromRotationVector(u * turn)).normalized()};
}

}  // namespace mane::math
