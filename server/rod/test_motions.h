#pragma once

#include <Eigen/Geometry>

#include <cmath>
#include <functional>

#include "math/rigid.h"
#include "rod/test_strands.h"

/// Violent motions of a head.
namespace mane::rod::fixtures {

/// Root pose at frame `i` of frames `dt` [s] apart.
using Motion = std::function<math::Pose(int i, double dt)>;

inline math::Pose Shake(int i, double dt) {  // 4 Hz, 10 cm to either side.
  return {{0.1 * std::sin(2 * M_PI * 4 * i * dt), 0, 0}, Eigen::Quaterniond::Identity()};
}

inline math::Pose SnapTurn(int i,
                           double dt) {  // Ninety degrees in 0.2 s to and fro, 10 cm off the axis.
  const double phase = std::fmod(i * dt, 0.8);
  const double part = phase < 0.2   ? phase / 0.2
                      : phase < 0.4 ? 1
                      : phase < 0.6 ? 3 - phase / 0.2
                                    : 0;
  const Eigen::Quaterniond q(Eigen::AngleAxisd(part * M_PI / 2, Eigen::Vector3d::UnitY()));
  return {q * Eigen::Vector3d(0.1, 0, 0), q};
}

inline math::Pose Teleport(int i,
                           double) {  // A metre and any turn within one step, each half second.
  Random random(i / 15);
  return {random.Direction(), random.Rotation()};
}

inline math::Pose Spin(int i, double) {  // Nearly half a turn every step, about changing axes.
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Random random(i / 50);
  const Eigen::AngleAxisd turn(0.99 * M_PI, random.Direction());
  for (int k = 0; k < i % 50; ++k) q = turn * q;
  return {{0, 0, 0}, q};
}

/// Jumps of a metre, any turns, standing still, high-frequency shakes, in any order: the pose after
/// `now`.
inline math::Pose Hostile(Random& random, const math::Pose& now, int i) {
  switch (i / 10 % 4) {
    case 0:
      return {random.Vector(1), random.Rotation()};
    case 1:
      return {now.p, math::FromRotationVector(3.1 * random.Direction()) * now.q};
    case 2:
      return now;
    default:
      return {now.p + random.Vector(0.1), math::FromRotationVector(random.Vector(0.5)) * now.q};
  }
}

}  // namespace mane::rod::fixtures
