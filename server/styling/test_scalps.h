#pragma once

#include "groom/groom.h"

namespace mane::styling {

inline constexpr double kDomeRadius = 0.1;

/// Cap of a sphere of radius kDomeRadius about `center`, within `angle` of +Y, in `rings` rings:
/// corners lie on the sphere to float32.
[[nodiscard]] groom::TriangleMesh Dome(const Eigen::Vector3d& center, double angle, int rings);

/// The square [0, 1] x [0, 1] in the plane y = 0, seen from above, of k x k quads.
[[nodiscard]] groom::TriangleMesh Square(int k);

/// An ellipsoid of a head's size with hair on a tilted cap.
[[nodiscard]] groom::Ellipsoid Head();

}  // namespace mane::styling
