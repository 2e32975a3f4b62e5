#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mane::math {

/// A frame's placement in its parent: parent = q * local + p. `q` is a unit quaternion.
struct Pose {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& local) const {
    return q * local + p;
  }
  [[nodiscard]] Pose operator*(const Pose& child) const {
    return {q * child.p + p, (q * child.q).normalized()};
  }
  [[nodiscard]] Pose Inverse() const {
    const Eigen::Quaterniond inverse = q.conjugate();
    return {-(inverse * p), inverse};
  }
};

/// The matrix of v x.
[[nodiscard]] inline Eigen::Matrix3d Cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Rotation vector [rad] of `q`, of length at most pi.
[[nodiscard]] Eigen::Vector3d RotationVector(const Eigen::Quaterniond& q);

/// Unit quaternion of a rotation vector [rad]; any length, zero included.
[[nodiscard]] Eigen::Quaterniond FromRotationVector(const Eigen::Vector3d& v);

/// Pose on the way from `a` (u = 0) to `b` (u = 1): straight line and shortest arc. `u` outside
/// [0, 1] extrapolates.
[[nodiscard]] Pose Interpolate(const Pose& a, const Pose& b, double u);

}  // namespace mane::math
