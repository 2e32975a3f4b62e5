#pragma once

namespace mane::inline client {

/// A point or a vector. Right-handed axes, Y up, SI units.
struct Vector3 {
  double x = 0;
  double y = 0;
  double z = 0;
};

/// A rotation as a unit quaternion; takes coordinates of the named frame to its parent's. The
/// server normalises a norm within 1 % of one and refuses anything else.
struct Quaternion {
  double x = 0;
  double y = 0;
  double z = 0;
  double w = 1;
};

/// Placement of a frame in its parent: parent = orientation * local + position.
struct Pose {
  Vector3 position;  ///< [m], each component within ±1e6.
  Quaternion orientation;
};

}  // namespace mane::inline client
