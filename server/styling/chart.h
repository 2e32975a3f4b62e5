#pragma once

#include <Eigen/Core>

#include "groom/groom.h"

namespace mane::styling {

/// A direction from the middle of the head.
struct Angles {
  double polar = 0;    ///< From +Y, in [0, pi] [rad].
  double azimuth = 0;  ///< From +Z, the front, toward +X, in (-pi, pi] [rad].
};

/// A place in an image: (0, 0) is its upper left corner, (1, 1) its lower right one.
struct ImagePoint {
  double u = 0.5;
  double v = 0.5;
};

/// Coordinates on a scalp: angles about its centre, and places in images of it (scalp.md, P1-P3).
///
/// Images show the head from above, forehead at the bottom, its left (+X) at the right, in the
/// azimuthal equidistant projection: distance from the middle is the polar angle, whose pi is the
/// circle that touches the image's sides.
///
/// Poles: at the top, the bottom and the centre itself the azimuth is 0. The top is the middle of
/// the image; the bottom is all of the circle, of which the lowest point is taken. Half a turn is
/// +pi, never -pi.
class ScalpChart {
 public:
  /// @param scalp  valid (groom::ValidateScalp) and not empty.
  ///
  /// The centre is an ellipsoid's; of a mesh, that of the sphere that fits its hair region best
  /// (P1), or, where that is no cap of a sphere, 4 of its rms radii below it (P2).
  explicit ScalpChart(const groom::Scalp& scalp);

  /// Head frame [m].
  [[nodiscard]] const Eigen::Vector3d& center() const { return center_; }

  /// Angles of a point of the head frame [m].
  [[nodiscard]] Angles At(const Eigen::Vector3d& point) const;

 private:
  Eigen::Vector3d center_;
};

/// Unit vector from the centre.
[[nodiscard]] Eigen::Vector3d DirectionOf(const Angles& angles);

/// (P3); inside the circle.
[[nodiscard]] ImagePoint ToImage(const Angles& angles);

/// Inverse of ToImage; what lies outside the circle is at the bottom, with its azimuth.
[[nodiscard]] Angles FromImage(const ImagePoint& point);

}  // namespace mane::styling
