#pragma once

#include "contact/distance.h"

namespace mane::contact {

/// An ellipsoid about the origin with its axes along the frame's.
///
/// The surface point x nearest to y solves y - x = t w, with w = y_i / (t + r_i^2) the outward
/// normal there and t the largest root of (D1). With s = t + r_min^2 nothing cancels, and Newton's
/// method on 1/|q(s)| = 1 climbs to the root from below for any radii (D2); the distance is
/// (s - r_min^2) |w| (D3). Numbers are those of contact.md.
class Ellipsoid {
 public:
  /// @param radii  [m], each positive.
  explicit Ellipsoid(const Eigen::Vector3d& radii) : radii_(radii) {}

  [[nodiscard]] const Eigen::Vector3d& radii() const { return radii_; }

  /// To rounding of the largest radius or of the point, for any ratio of the radii.
  [[nodiscard]] Distance At(const Eigen::Vector3d& point) const;

  /// The same in float32, to 3e-6 of the largest radius for radii of a ratio up to 100. No
  /// allocation, thread-safe.
  void At(const PointSpans& points, const DistanceSpans& out) const;

 private:
  Eigen::Vector3d radii_;
};

}  // namespace mane::contact
