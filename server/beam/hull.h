#pragma once

#include <Eigen/Core>

#include <numbers>
#include <span>

#include "base/result.h"

namespace mane::beam {

/// The unit vector at a zenith angle [rad] from +Y and an azimuth [rad] from +Z toward +X (B7).
[[nodiscard]] Eigen::Vector3d DirectionOf(double zenith, double azimuth);

/// The ellipsoid that stands for a head, its axes along the head frame's: E(p) = |(p - center) /
/// radii|^2 - 1 (beam.md, B1).
struct Hull {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d radii = Eigen::Vector3d::Ones();   ///< [m], each positive.

  /// E(p): below 0 inside, 0 on the surface, no unit.
  [[nodiscard]] double At(const Eigen::Vector3d& point) const;
  /// Gradient of E [1/m]: along the outward normal of the level that `point` lies on.
  [[nodiscard]] Eigen::Vector3d Gradient(const Eigen::Vector3d& point) const;
  /// The surface point at a zenith angle [rad] from +Y and an azimuth [rad] from +Z toward +X (B2).
  [[nodiscard]] Eigen::Vector3d Point(double zenith, double azimuth) const;
};

/// Polar coordinates on a hull (B2).
struct Polar {
  double zenith;   ///< In [0, pi].
  double azimuth;  ///< In [-pi, pi]; 0 at the poles.
};
/// Of the surface point that lies on the ray from the center through `point`, which is another one.
[[nodiscard]] Polar PolarOf(const Hull& hull, const Eigen::Vector3d& point);

/// The hull that kernels keep nodes out of in numbers of precision `epsilon`: larger by so little
/// that a node outside of it lies, rounded to float in the head frame, outside `hull` (B6).
[[nodiscard]] Hull Lifted(const Hull& hull, double epsilon);

/// The hull of a head: the ellipsoid whose E^2, summed over `points`, is least, then grown about
/// its center until it encloses all of them.
///
/// @param points  of the head's surface [m], at least 6 that no other quadric fits.
/// @return INVALID_ARGUMENT without a field where the points lie in a plane, or on something that
///         no ellipsoid comes near.
[[nodiscard]] Result<Hull> FitHull(std::span<const Eigen::Vector3f> points);

}  // namespace mane::beam
